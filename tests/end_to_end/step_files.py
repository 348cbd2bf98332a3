"""STEP files (AP214) of boxes, as text, with room for what CAD programs put beside the solids."""
import itertools


class StepFile:
    """Instances in the order in which they are added."""

    def __init__(self):
        self.lines = []

    def add(self, text):
        """Its name, "#12"."""
        self.lines.append(f"#{len(self.lines) + 1}={text};")
        return f"#{len(self.lines)}"

    def point(self, x):
        return self.add("CARTESIAN_POINT('',(%s))" % ",".join(repr(float(value)) for value in x))

    def direction(self, x):
        return self.add("DIRECTION('',(%s))" % ",".join(repr(float(value)) for value in x))

    def axes(self, origin, z, x):
        return self.add(f"AXIS2_PLACEMENT_3D('',{self.point(origin)},{self.direction(z)},{self.direction(x)})")

    def box(self, name, low, size):
        """A solid, mm."""
        at = {c: [low[k] + c[k] * size[k] for k in range(3)] for c in itertools.product((0, 1), repeat=3)}
        vertices = {c: self.add(f"VERTEX_POINT('',{self.point(at[c])})") for c in at}
        edges = {}
        for a in at:
            for k in range(3):
                if a[k] == 0:
                    b = tuple(1 if i == k else a[i] for i in range(3))
                    line = self.add("LINE('',%s,%s)" % (self.point(at[a]), self.add("VECTOR('',%s,1.)" % self.direction(
                        [float(i == k) for i in range(3)]))))
                    edges[a, b] = self.add(f"EDGE_CURVE('',{vertices[a]},{vertices[b]},{line},.T.)")
        faces = []
        for k, side in itertools.product(range(3), (0, 1)):
            first, second = (k + 1) % 3, (k + 2) % 3

            def corner(u, v):
                place = [0, 0, 0]
                place[k], place[first], place[second] = side, u, v
                return tuple(place)

            loop = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)]
            if side == 0:
                loop.reverse()
            oriented = []
            for a, b in zip(loop, loop[1:] + loop[:1]):
                forward = (a, b) in edges
                oriented.append(self.add(f"ORIENTED_EDGE('',*,*,{edges[(a, b) if forward else (b, a)]},.{'T' if forward else 'F'}.)"))
            bound = self.add("FACE_OUTER_BOUND('',%s,.T.)" % self.add("EDGE_LOOP('',(%s))" % ",".join(oriented)))
            normal, x = [0.0] * 3, [0.0] * 3
            normal[k], x[first] = 1.0 if side else -1.0, 1.0
            plane = self.add("PLANE('',%s)" % self.axes(at[corner(0, 0)], normal, x))
            faces.append(self.add(f"ADVANCED_FACE('',({bound}),{plane},.T.)"))
        return self.add("MANIFOLD_SOLID_BREP('%s',%s)" % (name, self.add("CLOSED_SHELL('',(%s))" % ",".join(faces))))

    def leader_line(self):
        """An annotation of a kind that OpenCASCADE does not know."""
        style = self.add("PRESENTATION_STYLE_ASSIGNMENT((%s))" % self.add("CURVE_STYLE('',%s,POSITIVE_LENGTH_MEASURE(0.2),%s)" % (
            self.add("DRAUGHTING_PRE_DEFINED_CURVE_FONT('continuous')"), self.add("COLOUR_RGB('',0.,0.,0.)"))))
        curve = self.add("GEOMETRIC_CURVE_SET('',(%s))" % self.add(
            f"POLYLINE('',({self.point((0, 0, 50))},{self.point((10, 20, 60))}))"))
        return self.add("(ANNOTATION_CURVE_OCCURRENCE()ANNOTATION_OCCURRENCE()DRAUGHTING_ANNOTATION_OCCURRENCE()"
                        f"GEOMETRIC_REPRESENTATION_ITEM()LEADER_CURVE()REPRESENTATION_ITEM('')STYLED_ITEM(({style}),{curve}))")

    def product(self, items, kind="ADVANCED_BREP_SHAPE_REPRESENTATION"):
        """The one product, whose shape the items are; its product definition."""
        length = self.add("(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.))")
        angle = self.add("(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))")
        solid_angle = self.add("(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())")
        context = self.add(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((%s))"
            "GLOBAL_UNIT_ASSIGNED_CONTEXT((%s,%s,%s))REPRESENTATION_CONTEXT('',''))" %
            (self.add(f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-6),{length},'distance_accuracy_value','')"),
             length, angle, solid_angle))
        application = self.add("APPLICATION_CONTEXT('automotive design')")
        self.add(f"APPLICATION_PROTOCOL_DEFINITION('','automotive_design',2000,{application})")
        product = self.add("PRODUCT('parts','parts','',(%s))" % self.add(f"PRODUCT_CONTEXT('',{application},'mechanical')"))
        self.add(f"PRODUCT_RELATED_PRODUCT_CATEGORY('part','',({product}))")
        definition = self.add("PRODUCT_DEFINITION('','',%s,%s)" % (
            self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})"),
            self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{application},'design')")))
        self.add("SHAPE_DEFINITION_REPRESENTATION(%s,%s)" % (
            self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})"),
            self.add(f"{kind}('',({','.join(items)}),{context})")))
        return definition

    def text(self):
        return ("ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\nFILE_NAME('parts','2026-01-01T00:00:00',(''),(''),'','','');\n"
                "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n" + "\n".join(self.lines) +
                "\nENDSEC;\nEND-ISO-10303-21;\n")


def boxes(*sizes, annotated=False):
    """The text of a file with boxes "box1" ...: (low corner, size), mm; `annotated`: with a leader line among them."""
    file = StepFile()
    items = [file.axes((0, 0, 0), (0, 0, 1), (1, 0, 0))]
    items += [file.box(f"box{number}", *size) for number, size in enumerate(sizes, 1)]
    if annotated:
        items.insert(1, file.leader_line())
    file.product(items)
    return file.text()

"""STL files in text, for the scripts beside this one."""


def write(name, triangles, digits):
    """Prints the triangles (three points each) with so many digits."""
    print(f"solid {name}")
    for triangle in triangles:
        print("facet normal 0 0 0\n outer loop")
        for point in triangle:
            print("  vertex " + " ".join(f"{c + 0.0:.{digits}g}" for c in point))
        print(" endloop\nendfacet")
    print(f"endsolid {name}")

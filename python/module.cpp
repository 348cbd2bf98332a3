/// Module cgcontact._cgcontact: scenes and results of the library for Python. Arrays are views of the results where
/// these lie in rows already (contact points), else copies.
#include <fmt/format.h>
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "contact/adaptive_run.hpp"
#include "contact/check.hpp"
#include "contact/nested_run.hpp"
#include "contact/results/figures/postprocess.hpp"
#include "core/base/errors/errors.hpp"
#include "core/base/errors/mistakes.hpp"
#include "core/base/process/memory.hpp"
#include "core/base/process/parallel.hpp"
#include "core/base/process/ranks.hpp"
#include "core/drawing/extremes.hpp"
#include "core/output/output.hpp"
#include "core/output/report/output_report.hpp"
#include "core/output/report/output_summary.hpp"
#include "core/program/study_options.hpp"
#include "core/results/warning_order.hpp"
#include "core/scene_file/read_scene.hpp"
#include "kernels/solver/linear_solver.hpp"
#include "python/trilinos_thread.hpp"

namespace py = pybind11;

namespace cgcontact {
namespace {

class PythonResult;

/// Trilinos, which is started once, and what has to go before it stops. Changed with Python's lock held.
struct Session {
  std::unique_ptr<TrilinosThread> trilinos;
  std::set<PythonResult*> results;
};
Session& session() {
  static Session only;
  return only;
}

/// threads = 0: the backend's default.
TrilinosThread& start(int threads) {
  if (!session().trilinos) session().trilinos = std::make_unique<TrilinosThread>(threads);
  return *session().trilinos;
}

/// Runs a task on the thread of Trilinos, without Python's lock; returns what it returns.
template <class Task>
auto on_trilinos(const Task& task) {
  using Result = decltype(task());
  TrilinosThread& trilinos = start(0);
  const py::gil_scoped_release released;
  if constexpr (std::is_void_v<Result>) {
    trilinos.run(task);
  } else {
    std::optional<Result> result;
    trilinos.run([&] { result.emplace(task()); });
    return std::move(*result);
  }
}

int num_threads() { return on_trilinos(&TrilinosScope::concurrency); }

/// Asked for by the user.
void set_threads(int threads) {
  parse_threads(std::to_string(threads));
  const bool starts = !session().trilinos;
  start(threads);
  if (!starts && threads != num_threads())
    throw InputError(fmt::format("set_threads({}): cgcontact runs on {} already (allowed: before the first scene)",
                                 threads, num_threads()));
}

/// Calls from C++ on what Python gave, on the thread that asked for the solve; also where Ctrl-C is seen.
class Listener {
 public:
  explicit Listener(py::object progress) : progress_(std::move(progress)) {}

  /// make_event: a dict, made once Python's lock is held.
  template <class MakeEvent>
  void tell(const MakeEvent& make_event) {
    session().trilinos->ask([&] {
      const py::gil_scoped_acquire held;
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      if (!progress_.is_none()) progress_(make_event());
    });
  }

 private:
  py::object progress_;
};

py::object optional_number(const std::optional<double>& value) { return value ? py::cast(*value) : py::none(); }

AdaptiveCallbacks callbacks_of(Listener& listener) {
  using namespace py::literals;
  AdaptiveCallbacks callbacks;
  callbacks.phase = [&](const std::string& name) { listener.tell([&] { return py::dict("phase"_a = name); }); };
  callbacks.step = [&](const OuterStep& s) {
    listener.tell([&] {
      return py::dict("iteration"_a = s.iteration, "active_points"_a = s.active_points, "residual"_a = s.residual);
    });
  };
  callbacks.solved = [&](int number, const SolveFigures& solve) {
    listener.tell([&] {
      return py::dict("solve"_a = number, "unknowns"_a = solve.unknowns, "seconds"_a = solve.seconds,
                      "pressure"_a = optional_number(solve.pressure), "force"_a = optional_number(solve.force),
                      "shear"_a = optional_number(solve.shear),
                      "stress"_a = optional_number(solve.converged ? std::optional(solve.stress) : std::nullopt));
    });
  };
  return callbacks;
}

/// A number per row (shape n) or several (n x width) as a view of the rows, which `owner` keeps.
template <class Value>
py::array view_of_rows(const std::vector<ContactRow>& rows, const Value ContactRow::*member, py::handle owner) {
  const auto n = static_cast<py::ssize_t>(rows.size());
  if (rows.empty()) return py::array_t<Value>(0);
  py::array view(py::dtype::of<Value>(), {n}, {static_cast<py::ssize_t>(sizeof(ContactRow))}, &(rows[0].*member),
                 owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

template <class Vector>
py::array view_of_vectors(const std::vector<ContactRow>& rows, const Vector ContactRow::*member, py::handle owner) {
  const auto n = static_cast<py::ssize_t>(rows.size());
  constexpr py::ssize_t width = Vector::SizeAtCompileTime;
  if (rows.empty()) return py::array_t<double>(std::vector<py::ssize_t>{0, width});
  py::array view(py::dtype::of<double>(), {n, width},
                 {static_cast<py::ssize_t>(sizeof(ContactRow)), static_cast<py::ssize_t>(sizeof(double))},
                 (rows[0].*member).data(), owner);
  view.attr("flags").attr("writeable") = false;
  return view;
}

/// n x width from vectors of that length.
template <class Vector>
py::array_t<double> array_of(const std::vector<Vector>& values) {
  constexpr py::ssize_t width = Vector::SizeAtCompileTime;
  py::array_t<double> array(std::vector<py::ssize_t>{static_cast<py::ssize_t>(values.size()), width});
  double* to = array.mutable_data();
  for (const Vector& value : values) to = std::copy(value.data(), value.data() + width, to);
  return array;
}

class PythonScene {
 public:
  explicit PythonScene(std::shared_ptr<const Scene> scene) : scene_(std::move(scene)) {}
  const std::shared_ptr<const Scene>& scene() const { return scene_; }

  std::string check() const {
    return on_trilinos([&] {
      const Scene on_grids = on_first_grids(*scene_);
      Preparation preparation = discretise(on_grids, false);
      validate(on_grids, preparation);
      return describe(on_grids, preparation);
    });
  }

 private:
  std::shared_ptr<const Scene> scene_;
};

class PythonResult {
 public:
  PythonResult(std::shared_ptr<const Scene> scene, const py::object& progress) : given_(std::move(scene)) {
    Listener listener(progress);
    const AdaptiveCallbacks callbacks = callbacks_of(listener);
    on_trilinos([&] {
      if (given_->accuracy.any()) {
        adaptive_ = std::make_unique<AdaptiveRun>(*given_);
        adaptive_->run(callbacks);
      } else {
        nested_ = std::make_unique<NestedRun>(*given_);
        nested_->run(callbacks);
      }
      results().backend = TrilinosScope::backend();
      results().threads = TrilinosScope::concurrency();
      fill_rank_figures(results());
      decisive_first(results().warnings);
    });
    session().results.insert(this);
  }
  ~PythonResult() { session().results.erase(this); }
  PythonResult(const PythonResult&) = delete;

  /// Before Trilinos stops.
  void release() {
    adaptive_.reset();
    nested_.reset();
  }

  Results& results() {
    if (!adaptive_ && !nested_) throw std::logic_error("cgcontact has ended");
    return adaptive_ ? adaptive_->simulation().results : nested_->simulation().results;
  }
  /// With the grids of the last solve.
  const Scene& solved_scene() const { return adaptive_ ? adaptive_->scene() : *given_; }

  std::string report() {
    return on_trilinos([&] {
      if (results().extremes.empty())
        results().extremes = extremes_of(results(), solved_scene(), draw_bodies(results()));
      return report_text(results(), {}, {});
    });
  }
  std::string summary_text() { return summary(results(), "memory"); }

  std::vector<std::string> write(const std::string& directory) {
    return on_trilinos([&] {
      check_output_directory(directory);
      return write_results(results(), solved_scene(), directory);
    });
  }

  py::dict contact(const py::object& self) {
    const std::vector<ContactRow>& rows = results().contact_rows;
    py::dict all;
    all["body"] = view_of_rows(rows, &ContactRow::body, self);
    all["pair"] = view_of_rows(rows, &ContactRow::pair, self);
    all["x"] = view_of_vectors(rows, &ContactRow::x, self);
    all["normal"] = view_of_vectors(rows, &ContactRow::normal, self);
    all["weight"] = view_of_rows(rows, &ContactRow::weight, self);
    all["gap"] = view_of_rows(rows, &ContactRow::gap, self);
    all["pressure_raw"] = view_of_rows(rows, &ContactRow::pressure_raw, self);
    all["pressure_spr"] = view_of_rows(rows, &ContactRow::pressure_spr, self);
    all["pressure_sprc"] = view_of_rows(rows, &ContactRow::pressure_sprc, self);
    all["pressure_error"] = view_of_rows(rows, &ContactRow::pressure_error, self);
    all["stress"] = view_of_vectors(rows, &ContactRow::stress_sprc, self);
    all["active"] = view_of_rows(rows, &ContactRow::active, self);
    if (!has_friction(results())) return all;
    all["shear_transmitted"] = view_of_vectors(rows, &ContactRow::shear_transmitted, self);
    all["shear"] = view_of_vectors(rows, &ContactRow::shear_sprc, self);
    all["slip"] = view_of_vectors(rows, &ContactRow::slip, self);
    all["travelled"] = view_of_rows(rows, &ContactRow::travelled, self);
    all["slips"] = view_of_rows(rows, &ContactRow::slips, self);
    all["wear"] = view_of_rows(rows, &ContactRow::wear, self);
    return all;
  }

  py::dict path() {
    const std::vector<PathSample>& samples = results().path;
    const auto n = static_cast<py::ssize_t>(samples.size());
    py::array_t<int> body(n), pair(n);
    py::array_t<double> s(n), raw(n), spr(n), sprc(n), reference(n);
    std::vector<Vec3> x;
    for (py::ssize_t i = 0; i < n; ++i) {
      const PathSample& sample = samples[i];
      body.mutable_at(i) = sample.body;
      pair.mutable_at(i) = sample.pair;
      s.mutable_at(i) = sample.s;
      raw.mutable_at(i) = sample.pressure_raw;
      spr.mutable_at(i) = sample.pressure_spr;
      sprc.mutable_at(i) = sample.pressure_sprc;
      reference.mutable_at(i) = sample.has_reference ? sample.pressure_reference : std::nan("");
      x.push_back(sample.x);
    }
    using namespace py::literals;
    return py::dict("body"_a = body, "pair"_a = pair, "s"_a = s, "x"_a = array_of(x), "pressure_raw"_a = raw,
                    "pressure_spr"_a = spr, "pressure_sprc"_a = sprc, "pressure_reference"_a = reference);
  }

  /// Number of the body that has a name.
  int body_named(const std::string& name) {
    const std::vector<BodyFields>& bodies = results().bodies;
    std::string names;
    for (std::size_t b = 0; b < bodies.size(); ++b) {
      if (bodies[b].name == name) return static_cast<int>(b);
      names += (b ? ", \"" : "\"") + bodies[b].name + "\"";
    }
    throw InputError(fmt::format("no body is named \"{}\" (allowed: {})", name, names));
  }

  py::dict cells(const std::string& name) {
    const BodyFields& body = results().bodies[body_named(name)];
    const CutCells& cut_cells = *body.cut_cells;
    const auto n = static_cast<py::ssize_t>(cut_cells.cells.size());
    std::vector<Vec3> centre;
    py::array_t<double> size(n), fraction(n);
    for (int c = 0; c < n; ++c) {
      centre.push_back(global_position(cut_cells, c, Vec3::Zero()));
      size.mutable_at(c) = cut_cells.h(c);
      fraction.mutable_at(c) = cut_cells.volume_fraction(c);
    }
    using namespace py::literals;
    return py::dict("centre"_a = array_of(centre), "size"_a = size, "volume_fraction"_a = fraction,
                    "error"_a = py::array_t<double>(body.error_of_cell.size(), body.error_of_cell.data()),
                    "energy"_a = py::array_t<double>(body.energy_of_cell.size(), body.energy_of_cell.data()),
                    "patch_kind"_a = py::array_t<unsigned char>(body.patch_kind.size(), body.patch_kind.data()),
                    "patch_status"_a = py::array_t<unsigned char>(body.patch_status.size(), body.patch_status.data()));
  }

  py::dict surface(const std::string& name) {
    const BodyFields& fields = results().bodies[body_named(name)];
    const DrawnBody drawn = on_trilinos([&] { return draw_body(fields); });
    py::array_t<int> triangles(
        std::vector<py::ssize_t>{static_cast<py::ssize_t>(drawn.mesh.boundary.size()), py::ssize_t{3}});
    int* to = triangles.mutable_data();
    for (const BoundaryTriangle& t : drawn.mesh.boundary) to = std::copy(t.points.begin(), t.points.end(), to);
    using namespace py::literals;
    return py::dict("points"_a = array_of(drawn.position), "triangles"_a = triangles,
                    "displacement"_a = array_of(drawn.displacement), "stress"_a = array_of(drawn.stress));
  }

  /// points: n x 3, undeformed, m. Without a name: in whichever body they lie.
  py::dict probe(const py::array_t<double, py::array::c_style | py::array::forcecast>& points,
                 const std::optional<std::string>& name) {
    if (points.ndim() != 2 || points.shape(1) != 3) throw InputError("points: expected an array of shape (n, 3)");
    const int only = name ? body_named(*name) : -1;
    const auto n = points.shape(0);
    py::array_t<int> body(n);
    std::vector<Vec3> displacement(n, Vec3::Constant(std::nan("")));
    std::vector<Sym3> stress(n, Sym3::Constant(std::nan(""))), raw = stress;
    py::array_t<double> mises(n);
    for (py::ssize_t i = 0; i < n; ++i) {
      const Vec3 x(points.at(i, 0), points.at(i, 1), points.at(i, 2));
      body.mutable_at(i) = -1;
      mises.mutable_at(i) = std::nan("");
      for (int b = 0; b < static_cast<int>(results().bodies.size()); ++b) {
        if (only >= 0 && b != only) continue;
        const BodyFields& fields = results().bodies[b];
        const CutCells& cut_cells = *fields.cut_cells;
        if (!solved_scene().bodies[b].holds(x)) continue;
        const Vec3 position = cut_cells.grid.to_grid(x);
        const int cell = cut_cells.locate(position);
        if (cell < 0) continue;
        const Vec3 xi = cell_coordinates(cut_cells, cell, position);
        body.mutable_at(i) = b;
        displacement[i] = fields.displacement(cell, xi);
        stress[i] = fields.stress_recovered(cell, xi);
        raw[i] = fields.stress_raw(cell, xi);
        mises.mutable_at(i) = von_mises(stress[i]);
        break;
      }
    }
    using namespace py::literals;
    return py::dict("body"_a = body, "displacement"_a = array_of(displacement), "stress"_a = array_of(stress),
                    "stress_raw"_a = array_of(raw), "von_mises"_a = mises);
  }

 private:
  std::shared_ptr<const Scene> given_;
  std::unique_ptr<AdaptiveRun> adaptive_;
  std::unique_ptr<NestedRun> nested_;
};

void stop() {
  for (PythonResult* result : session().results) result->release();
  session().results.clear();
  std::unique_ptr<TrilinosThread> last = std::move(session().trilinos);
  if (last && !last->lives_here()) last.release();
  const py::gil_scoped_release released;
  last.reset();
}

PythonScene parse_text(const std::string& text, const std::string& file, const std::vector<std::string>& overrides) {
  return PythonScene(on_trilinos([&] { return std::make_shared<const Scene>(parse_scene(text, file, overrides)); }));
}

PythonScene read_file(const std::string& file, const std::vector<std::string>& overrides) {
  return PythonScene(on_trilinos([&] { return std::make_shared<const Scene>(read_scene(file, overrides)); }));
}

}  // namespace
}  // namespace cgcontact

PYBIND11_MODULE(_cgcontact, module) {
  using namespace cgcontact;
  using namespace py::literals;
  static const py::exception<InputError> input_error(module, "InputError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {  // a name of a file need not be UTF-8, but a message in Python has to be
      std::string text;
      for (const std::string& message : messages_of(error))
        text += (text.empty() ? "" : "\n") + printable(message, message.size());
      PyErr_SetString(input_error.ptr(), text.c_str());
    }
  });
  module.attr("__version__") = CGCONTACT_VERSION;
  module.def("read", &read_file, "file"_a, "overrides"_a);
  module.def("parse", &parse_text, "text"_a, "file"_a, "overrides"_a);
  module.def("set_threads", &set_threads, "threads"_a,
             "Sets the number of threads (OpenMP backend), before the first scene. Raises InputError.");
  module.def("threads", &num_threads, "Number of threads.");
  module.def(
      "rank", [] { return on_trilinos(&this_rank); }, "Number of this MPI rank, from 0.");
  module.def(
      "ranks", [] { return on_trilinos(&num_ranks); }, "Number of MPI ranks.");
  module.def("stop", &stop);
  py::class_<PythonScene>(module, "Scene",
                          "A scene that has been read: `title`, `file`, `parameters` (SI units), `bodies` (names).")
      .def_property_readonly(
          "title", [](const PythonScene& s) { return s.scene()->title; }, "The scene's title.")
      .def_property_readonly(
          "file",
          [](const PythonScene& s) {
            const std::string& name = s.scene()->file;  // need not be UTF-8
            return py::reinterpret_steal<py::str>(
                PyUnicode_DecodeFSDefaultAndSize(name.data(), static_cast<py::ssize_t>(name.size())));
          },
          "Name of the file that was read.")
      .def_property_readonly(
          "parameters",
          [](const PythonScene& s) {
            std::map<std::string, double> values;
            for (const auto& [name, value] : s.scene()->parameters) values[name] = value;
            return values;
          },
          "Values of [parameters] by name, in SI units.")
      .def_property_readonly(
          "bodies",
          [](const PythonScene& s) {
            std::vector<std::string> names;
            for (const BodySpec& body : s.scene()->bodies) names.push_back(body.name);
            return names;
          },
          "Names of the bodies.")
      .def("check", &PythonScene::check,
           "The text of `cgcontact check`: cells, faces, pairs, what holds. Raises InputError.")
      .def("_solve", [](const PythonScene& s, const py::object& progress) {
        return std::make_unique<PythonResult>(s.scene(), progress);
      });
  py::class_<PythonResult>(module, "Result", "The result of a solve, with its fields.")
      .def("_report", &PythonResult::report)
      .def_property_readonly("summary", &PythonResult::summary_text, "What the terminal shows.")
      .def_property_readonly(
          "converged", [](PythonResult& r) { return r.results().converged; }, "Whether the solve has converged.")
      .def_property_readonly(
          "diagnosis", [](PythonResult& r) { return r.results().diagnosis; },
          "Why it has not converged; \"\" if it has.")
      .def_property_readonly(
          "unknowns", [](PythonResult& r) { return r.results().unknowns; }, "Number of unknowns.")
      .def_property_readonly(
          "warnings", [](PythonResult& r) { return r.results().warnings; }, "Warnings, one sentence each.")
      .def_property_readonly(
          "patch_kinds", [](PythonResult& r) { return r.results().patch_kinds; },
          "Names of the numbers of `patch_kind`.")
      .def_property_readonly(
          "patch_statuses", [](PythonResult& r) { return r.results().patch_statuses; },
          "Names of the numbers of `patch_status`.")
      .def_property_readonly(
          "contact", [](const py::object& self) { return self.cast<PythonResult&>().contact(self); },
          "Contact points: the columns of contact.csv as arrays (n,), m and Pa.")
      .def_property_readonly("path", &PythonResult::path,
                             "Pressure along the paths: the columns of pressure.csv as arrays (n,), m and Pa.")
      .def("cells", &PythonResult::cells, "body"_a,
           "Of the n active cells of a body: `centre` (n, 3) m, `size` m, `volume_fraction`, `error` (estimated, "
           "energy norm) "
           "sqrt(J), `energy` J, numbers of `patch_kind` and `patch_status`. Raises InputError.")
      .def(
          "surface", &PythonResult::surface, "body"_a,
          "The undeformed surface of a body: `points` (n, 3) m, `triangles` (m, 3), `displacement` (n, 3) m, recovered "
          "`stress` (n, 6: xx, yy, zz, xy, yz, zx) Pa. Raises InputError.")
      .def("probe", &PythonResult::probe, "points"_a, "body"_a = py::none())
      .def("write", &PythonResult::write, "directory"_a);
}

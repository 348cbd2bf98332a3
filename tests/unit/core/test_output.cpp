#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "core/base/files/hdf_file.hpp"
#include "core/base/files/text.hpp"
#include "core/drawing/clip_cells.hpp"
#include "core/output/output.hpp"
#include "core/output/report/output_summary.hpp"
#include "core/scene/displacement_field.hpp"
#include "tests/support/input_errors.hpp"

namespace cgcontact::test_output {
namespace {

namespace fs = std::filesystem;

constexpr double cell_size = 1e-3;

/// Two blocks on each other, 4 x 3 x 2 mm each, with linear displacement and stress.
struct Blocks {
  CutCells lower, upper;
  Results results;
  Scene scene;
};

CutCells block(double bottom) {
  Grid grid;
  grid.cell_size = cell_size;
  grid.origin = Vec3(-0.3, -0.6, bottom / cell_size - 0.4) * cell_size;
  grid.num_cells = {5, 4, 3};
  return make_cut_cells(Solid::box({0.3, 0.6, 0.4}, {4.3, 3.6, 2.4}, "block"), grid);
}

Vec3 position(const CutCells& cells, int cell, const Vec3& xi) {
  const Index3& c = cells.cells[cell];
  return cells.grid.to_global(Vec3(c[0], c[1], c[2]) + 0.5 * (xi + Vec3::Ones()));
}

void add_body(const std::string& name, const CutCells& cells, Results& results) {
  const CutCells* const own = &cells;
  BodyFields fields;
  fields.name = name;
  fields.cut_cells = own;
  fields.displacement = [own](int cell, const Vec3& xi) {
    return Vec3(1e-4 * position(*own, cell, xi)[1], 0, -2e-4 * position(*own, cell, xi)[2]);
  };
  fields.stress_recovered = [own](int cell, const Vec3& xi) {
    Sym3 s;
    s << 1, 2, 3, 4, 5, 1000 * position(*own, cell, xi)[0];
    return s;
  };
  fields.stress_raw = fields.stress_recovered;
  fields.error_of_cell.assign(cells.cells.size(), 0.5);
  fields.patch_kind.assign(cells.cells.size(), 1);
  fields.patch_status.assign(cells.cells.size(), 0);
  const int body = static_cast<int>(results.bodies.size());
  const double height = 2e-3;
  for (std::size_t i = 0; i < cells.boundary.size(); ++i) {
    ContactRow row;
    row.x = cells.grid.to_global(cells.boundary.position[i]);
    if (std::abs(row.x[2] - height) > 1e-12) continue;
    row.body = body;
    row.cell = cells.boundary.cell[i];
    row.normal = cells.boundary.normal[i];
    row.weight = cells.boundary.weight[i] * cell_size * cell_size;
    row.gap = 1e-9 / 3;
    row.pressure_raw = 1e6 / 3;
    row.pressure_spr = 1e6 * row.x[0];
    row.pressure_sprc = 2e6 / 7;
    row.pressure_error = 1e4 / 7;
    row.active = true;
    results.contact_rows.push_back(row);
    results.stress_errors.push_back({body, row.x, 3, 2, 1});
    results.path.push_back({body, 0, row.x[1], row.x, 1e6, 1.1e6, 1.2e6, true, 1.3e6});
  }
  results.bodies.push_back(fields);
}

std::unique_ptr<Blocks> make_blocks() {
  auto blocks = std::make_unique<Blocks>();
  blocks->lower = block(0);
  blocks->upper = block(2e-3);
  Results& results = blocks->results;
  results.scene_file = "scenes/blocks.toml";
  results.title = "two blocks";
  results.backend = "serial";
  results.converged = true;
  results.linear_iterations = {9, 4};
  results.linear_solver = {"flexible cg", "multigrid", {900, 120}, {14, 20}, {120}, 2};
  add_body("lower", blocks->lower, results);
  add_body("upper, \"second\"", blocks->upper, results);
  PairFigures pair;
  pair.active_points = 1;
  pair.name = "interface";
  pair.body_first = results.bodies[0].name;
  pair.body_second = results.bodies[1].name;
  pair.force_on_first = Vec3(0, 0, -12);
  pair.force_on_second = Vec3(0, 0, 12);
  pair.pressure_error_estimate = 0.05;
  pair.force_error_estimate = 0.004;
  results.pairs.push_back(pair);
  results.pressure_errors.push_back({"all", 0.3, 0.2, 0.1});
  results.patch_kinds = {"interior", "contact"};
  results.patch_statuses = {"exact", "truncated"};
  results.patches_by_kind = {{"interior", 3}, {"contact", 2}};
  results.patches_by_status = {{"exact", 4}, {"truncated", 1}};
  results.grown_patches = 1;
  results.times_s = {{"solve", 1.5}};
  return blocks;
}

/// A directory of its own for each test, removed at the end.
class output : public ::testing::Test {
 protected:
  output() {
    std::string pattern = (fs::temp_directory_path() / "cgcontact-test-XXXXXX").string();
    root_ = mkdtemp(pattern.data());
    out_ = (root_ / "result").string();
  }
  ~output() override { fs::remove_all(root_); }
  std::string file(const std::string& name) const { return out_ + "/" + name; }
  /// Scripts and data of the pictures stay in the folder plots.
  std::vector<std::string> write_without_gnuplot(Blocks& blocks) const {
    const std::string path = std::getenv("PATH");
    setenv("PATH", root_.c_str(), 1);
    const std::vector<std::string> warnings = write_results(blocks.results, blocks.scene, out_);
    setenv("PATH", path.c_str(), 1);
    return warnings;
  }
  /// Names in the parent directory: shows temporary directories left behind.
  std::set<std::string> siblings() const {
    std::set<std::string> names;
    for (const auto& entry : fs::directory_iterator(root_)) names.insert(entry.path().filename().string());
    return names;
  }
  std::string error_of(Results results, const Scene& scene, const std::string& directory) const {
    try {
      write_results(results, scene, directory);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  fs::path root_;
  std::string out_;
};

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// A run to an accuracy may end with a solve that is not the answer: its steps are on other cells.
TEST_F(output, steps_of_another_solve_are_left_out) {
  const auto answer = make_blocks(), last = make_blocks();
  answer->scene.steps.resize(2);
  answer->scene.output.plots = false;
  for (const bool same : {false, true}) {
    ResultWriter writer(answer->scene, out_);
    writer.add_step(0, (same ? answer : last)->results);
    Results results = answer->results;
    const std::vector<std::string> warnings = writer.write(results, answer->scene);
    EXPECT_EQ(warnings.empty(), same);
    EXPECT_TRUE(same || warnings.front().find("an earlier solve than the last") != std::string::npos);
    EXPECT_EQ(fs::exists(file("steps.vtkhdf")), same);
    EXPECT_TRUE(fs::exists(file("result.vtkhdf")));
  }
}

TEST_F(output, contact_csv_reads_back_to_ten_digits) {
  const auto blocks = make_blocks();
  blocks->scene.output.vtk = blocks->scene.output.plots = false;
  write_results(blocks->results, blocks->scene, out_);
  const std::vector<std::string> lines = lines_of(read_text(file("contact.csv")));
  ASSERT_EQ(lines.size(), blocks->results.contact_rows.size() + 1);
  EXPECT_EQ(lines[0],
            "body,pair,x,y,z,nx,ny,nz,weight,gap,pressure_raw,pressure_spr,pressure_sprc,pressure_error,active");
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const ContactRow& row = blocks->results.contact_rows[i - 1];
    const std::string name =
        (row.body == 0 ? "lower," : "\"upper, \"\"second\"\"\",") + blocks->results.pairs[row.pair].name + ",";
    ASSERT_EQ(lines[i].substr(0, name.size()), name);
    std::istringstream numbers(lines[i].substr(name.size()));
    const double expected[] = {row.x[0],          row.x[1],           row.x[2], row.normal[0],    row.normal[1],
                               row.normal[2],     row.weight,         row.gap,  row.pressure_raw, row.pressure_spr,
                               row.pressure_sprc, row.pressure_error, 1};
    for (double value : expected) {
      std::string text;
      std::getline(numbers, text, ',');
      EXPECT_NEAR(std::strtod(text.c_str(), nullptr), value, 5e-10 * std::abs(value)) << lines[i];
    }
  }
}

TEST_F(output, report_holds_the_figures) {
  const auto blocks = make_blocks();
  blocks->scene.output.vtk = blocks->scene.output.plots = false;
  blocks->results.estimated_error = std::nan("");
  write_results(blocks->results, blocks->scene, out_);
  const auto json = nlohmann::json::parse(read_text(file("report.json")));
  for (const char* key :
       {"scene", "version", "backend", "threads", "unknowns", "cells", "outer_iterations", "linear_iterations",
        "linear_solver", "active_points", "converged", "contact", "estimated_error", "recovery", "pressure_error",
        "times_s", "peak_memory_bytes", "warnings", "diagnosis"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_FALSE(json.contains("effectivity"));
  EXPECT_EQ(json["scene"], "scenes/blocks.toml");
  EXPECT_EQ(json["linear_iterations"], nlohmann::json({9, 4}));
  EXPECT_EQ(json["linear_solver"]["method"], "flexible cg");
  EXPECT_EQ(json["linear_solver"]["grids"],
            nlohmann::json({{{"unknowns", 900}, {"cycles", 14}}, {{"unknowns", 120}, {"cycles", 20}}}));
  EXPECT_EQ(json["linear_solver"]["muelu"], "direct");
  EXPECT_EQ(json["linear_solver"]["muelu_setups"], 2);
  EXPECT_EQ(json["contact"][0]["force"]["lower"], nlohmann::json({0, 0, -12}));
  EXPECT_EQ(json["contact"][0]["pressure_error_estimate"], 0.05);
  EXPECT_EQ(json["contact"][0]["force_error_estimate"], 0.004);
  EXPECT_EQ(json["contact"][0]["bodies"][1], "upper, \"second\"");
  EXPECT_TRUE(json["estimated_error"]["absolute"].is_null());
  EXPECT_EQ(json["recovery"]["patches"], nlohmann::json({{"interior", 3}, {"contact", 2}}));
  EXPECT_EQ(json["recovery"]["status"], nlohmann::json({{"exact", 4}, {"truncated", 1}}));
  EXPECT_EQ(json["recovery"]["grown_patches"], 1);
  EXPECT_EQ(json["pressure_error"][0]["sprc"], 0.1);
  EXPECT_EQ(json["times_s"]["solve"], 1.5);
  EXPECT_EQ(json["cells"]["active"], 0);
}

/// A run to 1 % of the pressure in so many solves.
AccuracyFigures solves_to_an_accuracy(int count, bool reached) {
  AccuracyFigures accuracy;
  accuracy.asked = true;
  accuracy.reached = reached;
  accuracy.pressure = 0.01;
  for (int k = 0; k < count; ++k) {
    SolveFigures solve;
    solve.unknowns = 5000 << k;
    solve.seconds = 0.5 * (k + 1);
    solve.outer_iterations = 7;
    solve.levels = k + 1;
    solve.smallest_cell = std::ldexp(1e-3, -k);
    solve.converged = true;
    if (k > 0) solve.pressure = reached && k + 1 == count ? 0.00783 : 0.04 / k;
    if (k > 1) solve.change = 0.03;
    solve.force = 0;  // given by the loads
    solve.stress = 0.5 / (k + 1);
    accuracy.solves.push_back(solve);
  }
  if (!reached) accuracy.text = "accuracy.max_unknowns stopped the refinement: 9,876,543 unknowns would be needed";
  return accuracy;
}

TEST_F(output, report_holds_the_solves_to_an_accuracy) {
  const auto blocks = make_blocks();
  blocks->scene.output.vtk = blocks->scene.output.plots = false;
  write_results(blocks->results, blocks->scene, out_);
  for (const char* key : {"accuracy", "singular_places"})
    EXPECT_FALSE(nlohmann::json::parse(read_text(file("report.json"))).contains(key)) << key;
  blocks->results.accuracy = solves_to_an_accuracy(3, false);
  blocks->results.accuracy.stress_of_body = {{"lower", 0.02}};
  blocks->results.accuracy.named = {{NamedTarget::Kind::displacement, "lower.tip", 0.03},
                                    {NamedTarget::Kind::pressure, "lower-upper", 0.2}};
  for (SolveFigures& solve : blocks->results.accuracy.solves) {
    solve.stress_of_body = {0.04};
    solve.named = {0.05, std::nullopt};
  }
  blocks->results.singular_points = {{"lower", {"base.x+", "base.z+"}, Vec3(1, 2, 3), 0.4, 1e-3}};
  write_results(blocks->results, blocks->scene, out_);
  const auto report = nlohmann::json::parse(read_text(file("report.json")));
  EXPECT_EQ(report["singular_places"], nlohmann::json::array({{{"body", "lower"},
                                                               {"faces", {"base.x+", "base.z+"}},
                                                               {"at", {1.0, 2.0, 3.0}},
                                                               {"exponent", 0.4},
                                                               {"cell", 1e-3}}}));
  const auto& json = report["accuracy"];
  EXPECT_EQ(json["targets"], nlohmann::json({{"pressure", 0.01},
                                             {"force", nullptr},
                                             {"shear", nullptr},
                                             {"stress", nullptr},
                                             {"stress_of_body", {{"lower", 0.02}}},
                                             {"displacement", {{"lower.tip", 0.03}}},
                                             {"pressure_of_pair", {{"lower-upper", 0.2}}}}));
  EXPECT_EQ(json["answer"], 3);
  EXPECT_EQ(json["reached"], false);
  EXPECT_EQ(json["text"], blocks->results.accuracy.text);
  ASSERT_EQ(json["solves"].size(), 3u);
  EXPECT_EQ(json["solves"][2], nlohmann::json({{"unknowns", 20000},
                                               {"seconds", 1.5},
                                               {"outer_iterations", 7},
                                               {"levels", 3},
                                               {"smallest_cell", 0.00025},
                                               {"converged", true},
                                               {"pressure", 0.02},
                                               {"force", 0.0},
                                               {"shear", nullptr},
                                               {"stress", 0.5 / 3},
                                               {"stress_of_body", {{"lower", 0.04}}},
                                               {"displacement", {{"lower.tip", 0.05}}},
                                               {"pressure_of_pair", {{"lower-upper", nullptr}}},
                                               {"change", 0.03}}));
  EXPECT_TRUE(json["solves"][0]["pressure"].is_null());
}

TEST_F(output, a_result_is_replaced_and_foreign_files_stay) {
  const auto blocks = make_blocks();
  blocks->scene.output.vtk = blocks->scene.output.plots = false;
  write_results(blocks->results, blocks->scene, out_);
  write_text(file("notes.txt"), "mine");
  blocks->scene.output.csv = false;
  blocks->results.title = "second";
  write_results(blocks->results, blocks->scene, out_ + "/");
  EXPECT_EQ(nlohmann::json::parse(read_text(file("report.json")))["title"], "second");
  EXPECT_FALSE(fs::exists(file("contact.csv")));
  EXPECT_EQ(read_text(file("notes.txt")), "mine");
  EXPECT_EQ(siblings(), std::set<std::string>{"result"});
}

TEST_F(output, parent_directories_are_made_and_an_empty_directory_is_used) {
  const auto blocks = make_blocks();
  blocks->scene.output.vtk = blocks->scene.output.plots = false;
  write_results(blocks->results, blocks->scene, out_ + "/a/b");
  EXPECT_TRUE(fs::exists(file("a/b/report.json")));
  fs::create_directory(root_ / "empty");
  EXPECT_NO_THROW(check_output_directory((root_ / "empty").string()));
  write_results(blocks->results, blocks->scene, (root_ / "empty").string());
  EXPECT_TRUE(fs::exists(root_ / "empty" / "report.json"));
}

TEST_F(output, other_directories_are_not_touched) {
  const auto blocks = make_blocks();
  fs::create_directory(out_);
  write_text(file("thesis.tex"), "years of work");
  EXPECT_NE(error_of(blocks->results, blocks->scene, out_).find("will not replace"), std::string::npos);
  EXPECT_THROW(check_output_directory(out_), InputError);
  write_text(file("report.json"), "{\"program\": \"another\"}");
  EXPECT_NE(error_of(blocks->results, blocks->scene, out_).find("not a report of cgcontact"), std::string::npos);
  write_text(file("report.json"), "not json");
  EXPECT_NE(error_of(blocks->results, blocks->scene, out_), "");
  EXPECT_EQ(read_text(file("thesis.tex")), "years of work");
  EXPECT_NE(error_of(blocks->results, blocks->scene, file("thesis.tex")).find("not a directory"), std::string::npos);
  EXPECT_NE(error_of(blocks->results, blocks->scene, file("thesis.tex/out")), "");
  EXPECT_THROW(check_output_directory(file("thesis.tex/out")), InputError);
  EXPECT_EQ(siblings(), std::set<std::string>{"result"});
}

/// Runs `work` with a limit on the size of files, which fails like a full disk.
template <class Work>
void with_file_limit(rlim_t bytes, const Work& work) {
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit limited{bytes, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &limited);
  work();
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
}

TEST_F(output, the_old_result_is_kept_when_writing_fails) {
  const auto blocks = make_blocks();
  write_results(blocks->results, blocks->scene, out_);
  const std::string report = read_text(file("report.json")), csv = read_text(file("contact.csv"));
  blocks->results.title = "second";
  for (rlim_t limit : {rlim_t{100}, rlim_t{csv.size() + 10}}) {
    std::string error;
    with_file_limit(limit, [&] { error = error_of(blocks->results, blocks->scene, out_); });
    EXPECT_NE(error.find("cannot write"), std::string::npos) << error;
    EXPECT_EQ(read_text(file("report.json")), report);
    EXPECT_EQ(read_text(file("contact.csv")), csv);
    EXPECT_EQ(siblings(), std::set<std::string>{"result"});
  }
}

/// Exit code of the check by VTK's own reader.
int check_vtk(const std::string& arguments) {
  const std::string python = fs::exists("/usr/bin/python3") ? "/usr/bin/python3" : "python3";
  const int status = std::system((python + " " CGCONTACT_SOURCE_DIR "/tests/check_vtk.py " + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// Rows that come in chunks of any size, also behind earlier ones, are those that come at once: across the borders of
// the chunks that the file is compressed in.
TEST_F(output, rows_that_come_chunk_by_chunk) {
  fs::create_directory(out_);
  HdfFile hdf(file("rows.h5"));
  constexpr std::size_t n = 150000;  // two borders
  std::vector<float> values;
  for (std::size_t i = 0; i < 3 * n; ++i) values.push_back(static_cast<float>(i));
  hdf.write("/at_once", values, 3);
  for (const bool grows : {false, true}) {
    const std::string path = grows ? "/growing" : "/fixed";
    const HdfStorage storage = grows ? HdfStorage::compressed : HdfStorage::plain;
    for (int step = 0; step < (grows ? 2 : 1); ++step) {
      HdfRows<float> rows(hdf, path, n, 3, storage, grows);
      for (std::size_t done = 0, size = 1; done < n; size = 3 * size + 1) {
        const std::size_t end = std::min(n, done + size);
        rows.add({values.begin() + 3 * done, values.begin() + 3 * end});
        done = end;
      }
      EXPECT_THROW(rows.add({1, 2, 3}), std::logic_error);
      EXPECT_EQ(hdf.read(path, step * n, n), values);
    }
  }
  EXPECT_EQ(hdf.read("/at_once", 0, n), values);
  EXPECT_EQ(hdf.read("/growing", n + 65000, 2000), hdf.read("/at_once", 65000, 2000));
  hdf.finish();
}

TEST_F(output, vtk_opens_the_bodies_and_the_contact_faces) {
  const auto blocks = make_blocks();
  blocks->scene.output.plots = false;
  write_results(blocks->results, blocks->scene, out_);
  std::size_t points = 0, cells = 0;
  for (const CutCells* body : {&blocks->lower, &blocks->upper}) {
    const ClippedMesh mesh = clip_cells(*body);
    points += mesh.num_points();
    cells += mesh.num_polyhedra();
  }
  const int status = check_vtk(fmt::format(
      "{} --points {} --cells {} --volume 48e-9 --tolerance 1e-12 --bounds 0 4e-3 0 3e-3 0 4e-3 "
      "--point-array displacement:3 --point-array stress_recovered:6 --point-array von_mises:1 --cell-array body:1 "
      "--cell-array stress_raw:6 --cell-array estimated_error:1 --cell-array estimated_error_density:1 "
      "--cell-array patch_kind:1 --cell-array patch_status:1",
      file("result.vtkhdf"), points, cells));
  const std::string bytes = read_text(file("result.vtkhdf"));  // attributes are not compressed
  EXPECT_NE(bytes.find("0 interior, 1 contact"), std::string::npos);
  EXPECT_NE(bytes.find("0 exact, 1 truncated"), std::string::npos);
  if (status == 77) GTEST_SKIP() << "python3-vtk9 is not installed";
  EXPECT_EQ(status, 0);
  EXPECT_EQ(
      check_vtk(fmt::format("{} --area 24e-6 --tolerance 1e-12 --bounds 0 4e-3 0 3e-3 2e-3 2e-3 "
                            "--cell-array pressure_sprc:1 --cell-array pressure_raw:1 --cell-array pressure_spr:1 "
                            "--cell-array gap:1 --cell-array status:1 --point-array pressure_sprc_smooth:1",
                            file("contact.vtkhdf"))),
      0);
}

TEST_F(output, without_gnuplot_scripts_and_data_stay_and_a_warning_says_so) {
  const auto blocks = make_blocks();
  const std::vector<std::string> warnings = write_without_gnuplot(*blocks);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("gnuplot"), std::string::npos);
  EXPECT_EQ(nlohmann::json::parse(read_text(file("report.json")))["warnings"][0], warnings[0]);
  for (const char* name : {"pressure.gp", "pressure.dat", "stress_error.gp", "stress_error.dat", "scene.gp"})
    EXPECT_TRUE(fs::exists(file(std::string("plots/") + name))) << name;
}

// A curve that ends at a plane of symmetry goes on behind it, from its own last point on; one that ends elsewhere, or
// where nothing is pressed, does not.
TEST_F(output, curves_go_on_behind_planes_of_symmetry) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.path.clear();
  for (int k = 0; k < 10; ++k) {
    PathSample sample;
    sample.s = 1e-3 + 1e-4 * k;
    sample.x = Vec3(1e-3, 1e-4 * (k + 0.5), 2e-3);
    sample.pressure_sprc = 2e6 - 1e5 * k;
    results.path.push_back(sample);
  }
  results.path_from_largest = true;
  const SymmetryPlane plane{Vec3::Zero(), -Vec3::UnitY()};
  results.pairs[0].zone.planes = {{Vec3::Zero(), -Vec3::UnitX()}, plane};
  write_without_gnuplot(*blocks);
  EXPECT_NE(read_text(file("plots/pressure.gp")).find("title 'mirrored at y = 0'"), std::string::npos);
  const std::string data = read_text(file("plots/pressure.dat"));
  std::istringstream image(data.substr(data.find("\n\n\n")));  // behind the only curve; in mm and MPa
  double s = 0, pressure = 0;
  for (int k = -1; k < 10; ++k) {
    ASSERT_TRUE(image >> s >> pressure);
    EXPECT_NEAR(s, k < 0 ? 1 : 0.9 - 0.1 * k, 1e-9);
    EXPECT_NEAR(pressure, 2 - 0.1 * std::max(k, 0), 1e-9);
  }
  EXPECT_FALSE(image >> s);
  results.path.front().pressure_sprc = 0;
  write_without_gnuplot(*blocks);
  EXPECT_EQ(read_text(file("plots/pressure.gp")).find("mirrored"), std::string::npos);
}

// A small contact zone is drawn from nearby beside the scene, one that takes most of it or nothing is not.
TEST_F(output, a_small_contact_zone_is_shown_from_nearby) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.pairs[0].max_pressure = 1e6;
  for (ContactRow& row : results.contact_rows)
    row.pressure_sprc = (row.x - Vec3(1.2e-3, 0.9e-3, 2e-3)).norm() < 0.5e-3 ? 1e6 : 0;
  write_without_gnuplot(*blocks);
  EXPECT_TRUE(fs::exists(file("plots/scene_zone.rgb")));
  EXPECT_NE(read_text(file("plots/scene.gp")).find("zone of interface, to scale"), std::string::npos);
  if (std::system("gnuplot --version > /dev/null 2>&1") == 0) {
    EXPECT_EQ(write_results(results, blocks->scene, out_), std::vector<std::string>{});
    EXPECT_NE(read_text(file("report.html")).find("and the contact zone of interface from nearby"), std::string::npos);
  }
  for (const double pressure : {1e6, 0.0}) {
    results.pairs[0].max_pressure = pressure;
    for (ContactRow& row : results.contact_rows) row.pressure_sprc = pressure;
    write_without_gnuplot(*blocks);
    EXPECT_FALSE(fs::exists(file("plots/scene_zone.rgb")));
    EXPECT_EQ(read_text(file("plots/scene.gp")).find("multiplot"), std::string::npos);
  }
}

TEST_F(output, gnuplot_draws_the_pictures) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const auto blocks = make_blocks();
  blocks->results.title = "braces {}, 'quotes' and \"more\", under_score ^ @ & ~ back\\slash `touch run` $(touch run)";
  EXPECT_EQ(write_results(blocks->results, blocks->scene, out_), std::vector<std::string>{});
  for (const char* name : {"pressure.svg", "stress_error.svg", "scene.png"})
    EXPECT_GT(fs::file_size(file(name)), 1000u) << name;
  const std::string picture = read_text(file("pressure.svg"));  // the title has more than one line
  for (const char* as_written : {"under_score ^ @ &amp; ~ back\\slash", "`touch", "run`", "$(touch", "run)"})
    EXPECT_NE(picture.find(as_written), std::string::npos) << as_written;
  EXPECT_FALSE(fs::exists(file("plots")));
}

TEST_F(output, the_story_of_a_run_to_an_accuracy_is_drawn) {
  if (std::system("gnuplot --version > /dev/null 2>&1") != 0) GTEST_SKIP() << "gnuplot is not installed";
  const auto blocks = make_blocks();
  write_results(blocks->results, blocks->scene, out_);
  for (const char* name : {"accuracy.svg", "grid.png"}) EXPECT_FALSE(fs::exists(file(name))) << name;
  for (const int count : {1, 4}) {  // one solve alone is one point on logarithmic axes
    blocks->results.accuracy = solves_to_an_accuracy(count, true);
    blocks->results.accuracy.stress_of_body = {{"lug", 0.02}};
    for (SolveFigures& solve : blocks->results.accuracy.solves) solve.stress_of_body = {0.1 / count};
    EXPECT_EQ(write_results(blocks->results, blocks->scene, out_), std::vector<std::string>{});
    for (const char* name : {"accuracy.svg", "grid.png"}) EXPECT_GT(fs::file_size(file(name)), 1000u) << name;
    EXPECT_NE(read_text(file("accuracy.svg")).find("pressure asked for"), std::string::npos);
    EXPECT_NE(read_text(file("accuracy.svg")).find("stress in lug asked for"), std::string::npos);
  }
  blocks->results.contact_rows.clear();  // no zone to look at, no estimates
  for (BodyFields& body : blocks->results.bodies) body.error_of_cell.clear();
  blocks->results.accuracy.solves = {SolveFigures()};
  EXPECT_EQ(write_results(blocks->results, blocks->scene, out_), std::vector<std::string>{});
  EXPECT_TRUE(fs::exists(file("grid.png")));
  EXPECT_FALSE(fs::exists(file("accuracy.svg")));
}

TEST_F(output, a_run_without_contact_or_recovery_is_written_too) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.bodies.pop_back();
  results.bodies[0].stress_recovered = nullptr;
  results.contact_rows.clear();
  results.stress_errors.clear();
  results.path.clear();
  results.pairs.clear();
  EXPECT_EQ(write_results(results, blocks->scene, out_), std::vector<std::string>{});
  EXPECT_TRUE(fs::exists(file("result.vtkhdf")));
  EXPECT_FALSE(fs::exists(file("contact.vtkhdf")));
  EXPECT_FALSE(fs::exists(file("contact.csv")));
}

TEST_F(output, a_run_that_went_wrong_is_written_too) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.converged = false;
  for (double wrong : {std::nan(""), HUGE_VAL, 1e200}) {
    for (BodyFields& body : results.bodies) {
      body.displacement = [=](int, const Vec3& xi) { return Vec3(wrong * xi[0], 0, wrong); };
      body.stress_recovered = [=](int, const Vec3& xi) { return Sym3(Sym3::Constant(wrong * xi[0])); };
    }
    for (ContactRow& row : results.contact_rows) row.pressure_sprc = row.gap = wrong;
    for (StressErrorSample& sample : results.stress_errors) sample.error_sprc = wrong;
    for (PathSample& sample : results.path) sample.pressure_sprc = wrong;
    EXPECT_NO_THROW(write_results(results, blocks->scene, out_)) << wrong;
    EXPECT_FALSE(nlohmann::json::parse(read_text(file("report.json")))["converged"]);
  }
}

TEST_F(output, the_summary_fits_one_screen) {
  const auto blocks = make_blocks();
  const std::vector<std::string> lines = lines_of(summary(blocks->results, out_));
  EXPECT_LT(lines.size(), 24u);
  EXPECT_EQ(lines[0], "solved: two blocks");
  blocks->results.converged = false;
  blocks->results.diagnosis = "the body lower can move along x";
  const std::string text = summary(blocks->results, out_);
  EXPECT_NE(text.find("DID NOT CONVERGE"), std::string::npos);
  EXPECT_NE(text.find("can move along x"), std::string::npos);
}

/// Columns on a terminal, of letters of one column each.
std::size_t width(const std::string& line) {
  return static_cast<std::size_t>(std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xc0) != 0x80; }));
}

TEST_F(output, the_summary_fits_one_screen_whatever_there_is) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.converged = false;
  results.title = "Äußere und innere Ringe, ";
  for (int k = 0; k < 5; ++k) results.title += results.title.substr(0, 40);
  for (int k = 0; k < 60; ++k) results.diagnosis += "the body cannot be held ";
  results.pairs[0].name = "a-name-of-a-contact-pair-that-is-longer-than-its-column";
  results.pairs.resize(200, results.pairs[0]);
  results.supports.resize(300);
  for (int k = 0; k < 40; ++k) {
    results.pressure_errors.push_back({"zone " + std::to_string(k), 0.123456, 0.2, 0.3});
    results.warnings.push_back(results.diagnosis);
  }
  results.times_s = {{"cut cells", 1e5}, {"operator", 2e5}, {"solve", 3e5}, {"recovery", 4e5}, {"output", 5e5}};
  results.peak_memory_bytes = 1'234'000'000;
  results.accuracy = solves_to_an_accuracy(12, false);
  const std::vector<std::string> lines = lines_of(summary(results, "out/some/where"));
  EXPECT_LE(lines.size(), 24u);
  for (const std::string& line : lines) EXPECT_LE(width(line), 80u) << line;
  const std::string text = summary(results, "out/some/where");
  for (const char* words : {"DID NOT CONVERGE", "diagnosis:", "more pairs, see the report", "more warnings",
                            "est. error:", "1.23 GB of memory", "results in out/some/where:"})
    EXPECT_NE(text.find(words), std::string::npos) << words;
}

TEST_F(output, the_summary_says_whether_the_accuracy_is_reached) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.accuracy = solves_to_an_accuracy(4, true);
  std::string text = summary(results, out_);
  for (const char* words : {"solved: two blocks", "reached after 4 solves, 5.0 s: estimated error of the pressure",
                            "0.783 % (asked: 1 %)", "cells from", "40,000", "125 um"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  results.accuracy = solves_to_an_accuracy(9, false);
  text = summary(results, out_);
  for (const char* words :
       {"solved, but NOT AS ACCURATE AS ASKED: two blocks", "NOT REACHED after 9 solves", "9,876,543"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  const std::vector<std::string> lines = lines_of(text);
  EXPECT_LE(lines.size(), 24u);
  for (const std::string& line : lines) EXPECT_LE(width(line), 80u) << line;
  results.accuracy.solves.back().pressure.reset();
  EXPECT_NE(summary(results, out_).find("not known, the zone"), std::string::npos);
  results.accuracy = solves_to_an_accuracy(4, true);
  results.accuracy.stress_of_body = {{"lug", 0.02}};
  for (SolveFigures& solve : results.accuracy.solves) solve.stress_of_body = {0.0123};
  EXPECT_NE(summary(results, out_).find("stress in lug"), std::string::npos);
}

TEST_F(output, the_summary_has_units_and_errors_and_says_what_to_open) {
  const auto blocks = make_blocks();
  Results& results = blocks->results;
  results.pairs[0].max_pressure = 9.4591e6;
  results.pairs[0].area = 2.646e-5;
  results.estimated_error_relative = 0.0643;
  write_results(results, blocks->scene, out_);
  const std::string text = summary(results, out_);
  for (const std::string words :
       {"12 N", "0.4 %", "9.4591 MPa", "5 %", "26.46 mm^2", "stress 6.4 % of the energy norm", "all 10 %"})
    EXPECT_NE(text.find(words), std::string::npos) << words << "\n" << text;
  EXPECT_NE(text.find("open next: " + out_ + "/report.html\n"), std::string::npos) << text;
  results.pairs[0].active_points = 0;  // nothing is transmitted: no relative errors
  EXPECT_EQ(summary(results, out_).find("0.4 %"), std::string::npos);
}

/// The body of a scene that displacements are read for.
BodySpec body_named(const std::string& name) {
  BodySpec body;
  body.name = name;
  return body;
}

/// Fields in a file are in single precision.
constexpr double single = 6e-8;

TEST_F(output, displacements_read_back_anywhere_in_a_body) {
  const auto blocks = make_blocks();
  blocks->scene.output.plots = blocks->scene.output.report = false;
  blocks->results.bodies[1].displacement = [&](int cell, const Vec3& xi) {
    const Vec3 x = 1e3 * position(blocks->upper, cell, xi);
    return Vec3(1e-6 * x[0] * x[1] * x[2], 0, 0);
  };
  write_results(blocks->results, blocks->scene, out_);
  // Linear: exact in cut cells too; the corners of the block are in such.
  const DisplacementField lower(out_, body_named("lower"));
  EXPECT_EQ(lower.cell_size(), cell_size);
  for (const Vec3& x : {Vec3(0, 0, 0), Vec3(4e-3, 3e-3, 2e-3), Vec3(1.234e-3, 1.9e-3, 0.7e-3), Vec3(3.9e-3, 1e-4, 1e-4),
                        Vec3(1.7e-3, 0.4e-3, 0.6e-3), Vec3(2e-3, 2.9999e-3, 1.1e-3)}) {
    const DisplacementField::Value found = lower.at(x);
    EXPECT_LT(found.distance, 1e-12) << x.transpose();
    EXPECT_LT((found.displacement - Vec3(1e-4 * x[1], 0, -2e-4 * x[2])).norm(), single * 5e-7) << x.transpose();
  }
  // Outside: the value at the nearest place, and how far that is.
  const DisplacementField::Value beside = lower.at({4.5e-3, 1.5e-3, 1e-3}), corner = lower.at({-3e-3, 7e-3, 2e-3});
  EXPECT_NEAR(beside.distance, 0.5e-3, 1e-12);
  EXPECT_LT((beside.displacement - Vec3(1.5e-7, 0, -2e-7)).norm(), single * 5e-7);
  EXPECT_NEAR(corner.distance, 5e-3, 1e-12);
  EXPECT_LT((corner.displacement - Vec3(3e-7, 0, -4e-7)).norm(), single * 5e-7);
  // Trilinear: exact in full cells.
  const DisplacementField upper(out_, body_named(blocks->results.bodies[1].name));
  for (const Vec3& x : {Vec3(1.2e-3, 1.1e-3, 2.9e-3), Vec3(2.6e-3, 1.6e-3, 3.4e-3), Vec3(3.1e-3, 2.2e-3, 3.5e-3)})
    EXPECT_NEAR(upper.at(x).displacement[0], 1e3 * x[0] * x[1] * x[2], single * 5e-5) << x.transpose();
}

TEST_F(output, displacements_of_what_is_no_result_are_refused) {
  const auto blocks = make_blocks();
  blocks->scene.output.plots = blocks->scene.output.report = false;
  const auto expect = [&](const BodySpec& body, const std::vector<std::string>& phrases) {
    expect_contains(message_of([&] { DisplacementField(out_, body); }), phrases);
  };
  expect(body_named("lower"), {"there is no directory " + out_});
  fs::create_directory(out_);
  expect(body_named("lower"), {"is no result of a run: it holds no report.json"});
  write_text(file("report.json"), "{\"program\": \"another\"}");
  expect(body_named("lower"), {"report.json is not a report of cgcontact"});
  write_text(file("report.json"), "not json");
  expect(body_named("lower"), {"report.json is not a report of cgcontact"});
  fs::remove_all(out_);
  write_results(blocks->results, blocks->scene, out_);
  expect(body_named("lowr"), {"no body \"lowr\" (did you mean \"lower\"?)", "it has lower, "});
  BodySpec flat = body_named("lower");
  flat.plane_strain = Coordinate::x;
  expect(flat, {"body \"lower\" is computed in three dimensions there and in plane strain across x here"});
  flat.unit_radius = 1;
  expect(flat, {"as a body of revolution about y here"});
  const std::string cells = read_text(file("result.vtkhdf"));
  write_text(file("result.vtkhdf"), cells.substr(0, cells.size() / 2));
  expect(body_named("lower"), {"result.vtkhdf cannot be read"});
  fs::remove(file("result.vtkhdf"));
  expect(body_named("lower"), {"has no displacements: it holds no result.vtkhdf (output.vtk = false)"});
  blocks->results.converged = false;
  write_results(blocks->results, blocks->scene, out_);
  expect(body_named("lower"), {"did not converge"});
}

TEST(output_text, numbers_for_people) {
  EXPECT_EQ(scaled(9373180, "Pa"), "9.373 MPa");
  EXPECT_EQ(scaled(0, "N"), "0 N");
  EXPECT_EQ(scaled(-0.0123, "N"), "-12.3 mN");
  EXPECT_EQ(short_number(1.23456e-7), "1.235e-07");
  EXPECT_EQ(percent_number(0.0041234), "0.41");
  EXPECT_EQ(percent_number(0.9949), "99");
  EXPECT_EQ(percent_number(11.2), "1120");
  EXPECT_EQ(percent_number(1e5), "over 9999");
  EXPECT_DOUBLE_EQ(two_digits(0.01849), 0.018);
  EXPECT_DOUBLE_EQ(two_digits(99.6), 100);
  EXPECT_EQ(at_position(Vec3(0.00123456, 0, -3)), "at (0.001235, 0, -3) m");
  EXPECT_EQ(trimmed("\t a b \r"), "a b");
  EXPECT_EQ(trimmed(" \t"), "");
  EXPECT_EQ(trimmed(""), "");
}

}  // namespace
}  // namespace cgcontact::test_output

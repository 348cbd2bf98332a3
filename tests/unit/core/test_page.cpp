#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "core/base/files/text.hpp"
#include "core/drawing/face_chart.hpp"
#include "core/output/report/output_page.hpp"

namespace cgcontact::test_page {
namespace {

Results small_results() {
  Results results;
  results.scene_file = "scenes/a.toml";
  results.title = "A title";
  results.backend = "Serial";
  results.converged = true;
  results.outer_iterations = 2;
  results.linear_iterations = {7, 5, 3};
  results.outer_residuals = {1.0, 2.5e-7};
  results.active_of_iteration = {12, 11};
  results.estimated_error_relative = 0.0625;
  PairFigures pair;
  pair.name = "lower-upper";
  pair.body_first = "lower";
  pair.body_second = "upper";
  pair.force_on_first = Vec3(0, 3e3, -4e3);
  pair.max_pressure = 9.5e6;
  pair.area = 2.5e-5;
  pair.points = 20;
  pair.active_points = 11;
  pair.pressure_error_estimate = 0.03;
  pair.force_error_estimate = 0.004;
  results.pairs = {pair};
  results.supports = {{"upper.z+", Vec3(0, 0, 7), "symmetry", 1e-4}};
  results.balance = {{"lower", Vec3(1, 0, 0), Vec3(-3, 0, 0), Vec3(2, 0, 0)}};
  results.pressure_errors = {{"whole", 0.5, 0.25, 0.125}};
  results.patches_by_kind = {{"interior", 1234}, {"contact", 8}};
  results.patches_by_status = {{"exact", 1200}, {"conflicting", 42}};
  results.times_s = {{"solve", 1.5}, {"output", 0.5}};
  return results;
}

bool has(const std::string& text, const std::string& words) { return text.find(words) != std::string::npos; }

TEST(page, every_section_is_there_with_its_figures) {
  const std::string text = page(small_results(), {});
  for (const char* id :
       {"verdict", "reliability", "contact", "reference", "balance", "convergence", "recovery", "cost", "reproduce"})
    EXPECT_TRUE(has(text, "<section id=\"" + std::string(id) + "\">")) << id;
  for (const char* shown : {"<data value=\"5000\">5&#160;kN</data>", "<data value=\"9500000\">9.5&#160;MPa</data>",
                            "<data value=\"2.5e-05\">25&#160;mm²</data>", "<data value=\"0.03\">3&#160;%</data>",
                            "<data value=\"0.004\">0.4&#160;%</data>", "<data value=\"0.125\">12&#160;%</data>",
                            "<data value=\"1234\">1,234</data>", "<data value=\"2.5e-07\">2.5e-07</data>",
                            "<data value=\"1.5\">1.50&#160;s", "contradict each other", "last solve"})
    EXPECT_TRUE(has(text, shown)) << shown;
}

TEST(page, what_the_run_has_not_is_left_out) {
  Results results;
  results.scene_file = "scene.toml";
  const std::string text = page(results, {});
  for (const char* id : {"picture", "pressure", "profile", "reference", "balance", "bodies", "convergence", "recovery"})
    EXPECT_FALSE(has(text, "<section id=\"" + std::string(id) + "\">")) << id;
  EXPECT_TRUE(has(text, "The scene has no contact pair."));
  EXPECT_TRUE(has(text, "<h1>scene.toml</h1>"));
}

TEST(page, texts_of_the_scene_are_escaped) {
  const std::string nasty = "<script>alert('1')</script> & \"x\"", safe = html_text(nasty);
  EXPECT_EQ(safe, "&lt;script&gt;alert(&#39;1&#39;)&lt;/script&gt; &amp; &quot;x&quot;");
  Results results = small_results();
  results.title = results.scene_file = results.diagnosis = results.backend = results.command = nasty;
  results.warnings = {nasty};
  results.pairs[0].name = results.pairs[0].body_first = nasty;
  results.supports[0].face = results.balance[0].body = nasty;
  results.pressure_errors[0].zone = results.patches_by_kind[0].first = results.times_s[0].first = nasty;
  results.converged = false;
  PageContents contents;
  contents.files = {nasty};
  const std::string text = page(results, contents);
  EXPECT_FALSE(has(text, "<script"));
  EXPECT_FALSE(has(text, "alert('1')"));
  EXPECT_TRUE(has(text, safe));
}

TEST(page, large_pictures_that_the_view_shows_lie_beside_it) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "cgcontact-test-page-view";
  std::filesystem::create_directories(folder);
  const auto write = [&](const std::string& file, std::size_t bytes) {
    write_text((folder / file).string(), std::string(bytes, 'x'));
  };
  PageContents contents;
  contents.directory = folder.string();
  contents.steps = {"step_1.png", "step_2.png"};
  contents.pressure_maps = {{0, "pressure_map.png", ""}, {0, "pressure_map_2.png", ""}};
  for (const char* file : {"step_1.png", "step_2.png", "pressure_map.png", "pressure_map_2.png", "conditions.png"})
    write(file, pictures_beside_view / 4);
  EXPECT_TRUE(pictures_for_view(contents).empty());  // no view
  contents.view.json = "{}";
  EXPECT_EQ(pictures_for_view(contents), (std::set<std::string>{"step_1.png", "step_2.png"}));
  write("conditions.png", pictures_beside_view);
  EXPECT_EQ(pictures_for_view(contents), (std::set<std::string>{"step_1.png", "step_2.png", "conditions.png"}));
  write("pressure_map.png", pictures_beside_view);
  contents.beside = pictures_for_view(contents);
  EXPECT_EQ(contents.beside,
            (std::set<std::string>{"step_1.png", "step_2.png", "conditions.png", "pressure_map_2.png"}));
  Results results = small_results();
  results.steps.resize(2);
  const std::string text = page(results, contents);
  EXPECT_TRUE(has(text, "their pictures, step_1.png to step_2.png, lie beside this page"));
  EXPECT_TRUE(has(text, "conditions.png lies beside the page"));
  std::filesystem::remove_all(folder);
}

TEST(page, nothing_outside_is_referred_to) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "cgcontact-test-page";
  std::filesystem::create_directories(folder);
  write_text((folder / "scene.png").string(), "not really a picture");
  PageContents contents;
  contents.directory = folder.string();
  const std::string text = page(small_results(), contents);
  EXPECT_TRUE(has(text, "src=\"data:image/png;base64," + base64("not really a picture") + "\""));
  EXPECT_FALSE(has(text, "http"));
  EXPECT_FALSE(has(text, "href"));
  EXPECT_FALSE(has(text, "@import"));
  EXPECT_FALSE(has(text, "url("));
  const std::regex source("src=\"(?!data:)");
  EXPECT_FALSE(std::regex_search(text, source));
  std::filesystem::remove_all(folder);
}

TEST(page, a_run_that_did_not_converge_says_so_first) {
  Results results = small_results();
  results.converged = false;
  results.diagnosis = "the linear solver stopped";
  const std::string text = page(results, {});
  EXPECT_LT(text.find("Did not converge"), text.find("<h2>"));
  EXPECT_LT(text.find("the linear solver stopped"), text.find("<h2>"));
  EXPECT_FALSE(has(text, "verdict good"));
}

AccuracyFigures two_solves(bool reached) {
  AccuracyFigures accuracy;
  accuracy.asked = true;
  accuracy.reached = reached;
  accuracy.pressure = 0.01;
  accuracy.stress = 0.05;
  SolveFigures solve;
  solve.unknowns = 5120;
  solve.seconds = 0.25;
  solve.stress = 0.5;
  solve.smallest_cell = 1e-3;
  solve.converged = true;
  accuracy.solves = {solve, solve};
  accuracy.solves[1].unknowns = 123456;
  accuracy.solves[1].pressure = reached ? 0.00783 : 0.0104;
  accuracy.solves[1].change = 0.02;
  accuracy.solves[1].stress = 0.03125;
  return accuracy;
}

TEST(page, the_solves_to_an_accuracy_are_listed) {
  Results results = small_results();
  EXPECT_FALSE(has(page(results, {}), "<section id=\"accuracy\">"));
  results.accuracy = two_solves(true);
  std::string text = page(results, {});
  for (const char* shown :
       {"<section id=\"accuracy\">", "verdict good", "is reached after 2 solves: estimated error of the pressure",
        "<data value=\"0.00783\">0.783 %</data> (asked: <data value=\"0.01\">1 %</data>)",
        "<data value=\"123456\">123,456</data>", "<data value=\"0.02\">2&#160;%</data>", "All solves: 2 solves, 0.5 s"})
    EXPECT_TRUE(has(text, shown)) << shown;
  results.accuracy = two_solves(false);
  results.accuracy.text = "accuracy.max_time stopped <the refinement>";
  text = page(results, {});
  for (const char* shown : {"verdict doubtful", "not as accurate as asked", "<b>not reached</b>", "1.04 %",
                            "; accuracy.max_time stopped &lt;the refinement&gt;."})
    EXPECT_TRUE(has(text, shown)) << shown;
  results.accuracy.solves.back().pressure.reset();
  EXPECT_TRUE(has(page(results, {}), "not known, the contact zone is not resolved"));
  results.accuracy.stress_of_body = {{"lug", 0.02}};
  for (SolveFigures& solve : results.accuracy.solves) solve.stress_of_body = {0.0234};
  text = page(results, {});
  for (const char* shown : {"of that in lug</th>", "of the stress in lug <data value=\"0.0234\">2.34 %</data> (asked"})
    EXPECT_TRUE(has(text, shown)) << shown;
}

TEST(page, values_that_are_not_numbers_are_called_so) {
  Results results = small_results();
  results.pairs[0].max_pressure = results.estimated_error_relative = std::nan("");
  results.outer_residuals = {HUGE_VAL, std::nan("")};
  EXPECT_TRUE(has(page(results, {}), "<data value=\"nan\">not a number</data>"));
}

TEST(output_text, base64_of_all_remainders) {  // RFC 4648, section 10
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64(std::string("\xff\xfe\x00", 3)), "//4A");
}

TEST(output_text, words_of_a_command_line_are_quoted_where_needed) {
  EXPECT_EQ(shell_word("n=16"), "n=16");
  EXPECT_EQ(shell_word("title=it's; rm"), "'title=it'\\''s; rm'");
  EXPECT_EQ(shell_word(""), "''");
}

TEST(output_text, lines_are_wrapped_at_blanks) {
  EXPECT_EQ(wrapped("aa bb cc", "x: ", 8), (std::vector<std::string>{"x: aa bb", "   cc"}));
  EXPECT_EQ(wrapped("", "x: ", 8), (std::vector<std::string>{"x: "}));
  EXPECT_EQ(wrapped("longer-than-a-line b", "", 5), (std::vector<std::string>{"longer-than-a-line", "b"}));
  EXPECT_EQ(columns_of("ä日"), 3);
}

TEST(output_text, integers_are_grouped) {
  EXPECT_EQ(grouped(7), "7");
  EXPECT_EQ(grouped(123), "123");
  EXPECT_EQ(grouped(-1234), "-1,234");
  EXPECT_EQ(grouped(10056324), "10,056,324");
}

/// Sector of a cylinder about an axis parallel to y: rows of squares of two triangles, normals away from the axis.
struct CylinderFace {
  std::vector<Vec3> points;
  FaceTriangles face;
};

CylinderFace cylinder(double from, double to, double radius, bool bore) {
  constexpr int n = 64;
  CylinderFace cylinder;
  for (int i = 0; i <= n; ++i)
    for (double y : {0.0, 0.1}) {
      const double a = from + (to - from) * i / n;
      cylinder.points.emplace_back(3 + radius * std::cos(a), y, -2 + radius * std::sin(a));
    }
  for (int i = 0; i < n; ++i)
    for (std::array<int, 3> t : {std::array<int, 3>{2 * i, 2 * i + 1, 2 * i + 2}, {2 * i + 2, 2 * i + 1, 2 * i + 3}}) {
      if (bore) std::swap(t[1], t[2]);
      cylinder.face.triangles.push_back(t);
    }
  return cylinder;
}

TEST(face_chart, cylinders_are_unrolled) {
  for (const bool bore : {false, true})
    for (const double to : {1.5, 5.0}) {
      CylinderFace sector = cylinder(-0.4, to, 0.7, bore);
      sector.face.position = &sector.points;
      const FaceChart chart(sector.face);
      ASSERT_TRUE(chart.unrolled());
      EXPECT_EQ(chart.mirrored(), bore);
      const double arc = std::abs(chart.position(sector.points.front())[0] - chart.position(sector.points.back())[0]);
      EXPECT_NEAR(arc, 0.7 * (to + 0.4), 1e-9);
      EXPECT_NEAR(chart.position(sector.points[1])[1] - chart.position(sector.points[0])[1], 0.1, 1e-12);
      EXPECT_EQ(chart.up_name(), "y");
      // Triangles as seen on paper are counterclockwise, unless it is mirrored.
      for (const auto& t : sector.face.triangles) {
        const Vec3 centre = (sector.points[t[0]] + sector.points[t[1]] + sector.points[t[2]]) / 3;
        Vec3 p[3];
        for (int v = 0; v < 3; ++v) p[v] = chart.position(sector.points[t[v]], centre);
        EXPECT_EQ((p[1] - p[0]).cross(p[2] - p[0])[2] > 0, !bore);
      }
    }
}

TEST(face_chart, flat_faces_are_seen_along_their_axis) {
  const std::vector<Vec3> points{{0, 5, 0}, {2, 5, 0}, {0, 5, 1}};
  FaceTriangles face{&points, {{0, 1, 2}}};  // normal -y
  const FaceChart chart(face);
  EXPECT_FALSE(chart.unrolled());
  EXPECT_FALSE(chart.mirrored());
  EXPECT_EQ(chart.right_name() + chart.up_name(), "xz");
  EXPECT_LT((chart.position(points[1]) - Vec3(2, 0, -5)).norm(), 1e-15);
  face.triangles[0] = {0, 2, 1};
  EXPECT_TRUE(FaceChart(face).mirrored());
}

}  // namespace
}  // namespace cgcontact::test_page

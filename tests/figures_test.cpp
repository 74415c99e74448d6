// The pictures that the program makes: files that any reader takes, and what they must show.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <sys/wait.h>

#include "program.h"

namespace nuno {
namespace {

class Pictures : public Program {
 protected:
  /// Runs a shell's command. The words are our own; no shell meets a stranger's text here.
  Outcome run(const std::string& command) const {
    const fs::path out = in_folder("stdout"), err = in_folder("stderr");
    const int status =
        std::system((command + " >" + word(out) + " 2>" + word(err) + " </dev/null").c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, read_text(out), read_text(err)};
  }

  /// A small throw of half a second.
  std::string result(const std::string& backend = "native") const {
    const fs::path scene = in_folder("throw <&>.json");
    write_text(scene, right_scene().dump());
    const std::string file = in_folder(backend + ".json");
    const Outcome made =
        nuno({"simulate", scene, "--alpha", "0.05", "--backend", backend, "--out", file});
    EXPECT_EQ(made.status, 0) << made.err;
    return file;
  }
};

/// Why a text is no XML that an SVG reader takes; empty if it is. Knows what our files use: tags,
/// attributes in double quotes, four entities.
std::string xml_mistake(const std::string& text) {
  std::vector<std::string> open;
  std::size_t at = 0;
  while (at < text.size()) {
    if (text[at] != '<') {
      const std::string entity = text[at] == '&' ? text.substr(at, text.find(';', at) - at) : "";
      if (text[at] == '&' && entity != "&amp" && entity != "&lt" && entity != "&gt" &&
          entity != "&quot") {
        return "a stray & at " + std::to_string(at);
      }
      ++at;
      continue;
    }
    const std::size_t end = text.find('>', at);
    if (end == std::string::npos) return "a tag without an end";
    std::string inside = text.substr(at + 1, end - at - 1);
    if (inside.find('<') != std::string::npos) return "a tag in a tag: " + inside.substr(0, 80);
    if (std::ranges::count(inside, '"') % 2 != 0) return "an open quote: " + inside.substr(0, 80);
    const bool closes = inside.starts_with("/"), empty = inside.ends_with("/");
    const std::string name = inside.substr(closes, inside.find_first_of(" /", closes) - closes);
    if (closes) {
      if (open.empty() || open.back() != name) return "</" + name + "> closes nothing";
      open.pop_back();
    } else if (!empty) {
      open.push_back(name);
    }
    at = end + 1;
  }
  return open.empty() ? "" : "<" + open.back() + "> stays open";
}

bool is_svg(const std::string& text) {
  return text.starts_with("<svg ") && xml_mistake(text).empty();
}

/// Every number of a text, in order.
std::vector<double> numbers(const std::string& text) {
  std::vector<double> result;
  for (const char* at = text.c_str(); *at != '\0';) {
    char* end = nullptr;
    const bool starts = std::isdigit(static_cast<unsigned char>(*at)) != 0;
    const double value = starts ? std::strtod(at, &end) : 0;
    if (starts) result.push_back(value);
    at = starts ? end : at + 1;
  }
  return result;
}

using Places = std::vector<std::array<double, 2>>;

/// Every polyline of a drawing with exactly this class, in order [px].
std::vector<Places> polylines(const std::string& svg, const std::string& style) {
  std::vector<Places> result;
  const std::string start = "<polyline class=\"line " + style + "\" points=\"";
  for (std::size_t at = svg.find(start); at != std::string::npos; at = svg.find(start, at + 1)) {
    const std::size_t first = at + start.size();
    const std::vector<double> flat = numbers(svg.substr(first, svg.find('"', first) - first));
    result.emplace_back();
    for (std::size_t i = 0; i + 1 < flat.size(); i += 2) {
      result.back().push_back({flat[i], flat[i + 1]});
    }
  }
  return result;
}

double distance(const std::array<double, 2>& a, const std::array<double, 2>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1]);
}

/// The paper's figures, made anew for every test.
class PaperFigures : public Pictures {
 protected:
  void SetUp() override { made_ = nuno({"figures", "--out", in_folder("figures")}); }

  std::string figure(int n) const {
    return read_text(in_folder("figures") / ("figure-" + std::to_string(n) + ".svg"));
  }

  Outcome made_;
};

TEST_F(PaperFigures, AreWellFormedLightAndDarkAndPictures) {
  if (is_installed("rsvg-convert")) {
    EXPECT_EQ(made_.status, 0) << made_.err;
  }
  for (const std::string name : {"figure-5", "figure-6", "figure-7", "figure-8"}) {
    const std::string svg = read_text(in_folder("figures") / (name + ".svg"));
    EXPECT_TRUE(is_svg(svg)) << name << ": " << xml_mistake(svg);
    EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos) << name;
    if (!is_installed("rsvg-convert")) continue;
    const std::string png = read_text(in_folder("figures") / (name + ".png"));
    ASSERT_GT(png.size(), 1000u);
    EXPECT_TRUE(png.starts_with("\x89PNG")) << name;
    // The width in the header, big-endian: twice the drawing's 800.
    EXPECT_EQ(static_cast<unsigned char>(png[18]) * 256 + static_cast<unsigned char>(png[19]),
              1600);
  }
}

TEST_F(PaperFigures, HaveUnitsAndNameWhatTheyShow) {
  for (const std::string text :
       {"gain α [N/m]", "error at arrival [% of L]", "launch only", "local minimum",
        // The paper's first valley.
        "the descent ends in the first valley: α = 0.0181 N/m, 2.17 %"}) {
    EXPECT_NE(figure(5).find(text), std::string::npos) << text;
  }
  for (const int n : {6, 7, 8}) {
    for (const std::string text : {"x [m]", "y [m]", "initial", "target", "final", "centroid"}) {
      EXPECT_NE(figure(n).find(text), std::string::npos) << n << ": " << text;
    }
  }
  EXPECT_NE(figure(6).find("32 particles, α = 0 N/m"), std::string::npos);
  EXPECT_NE(figure(7).find("32 particles, α = 0.0181 N/m"), std::string::npos);
  EXPECT_NE(figure(8).find("64 particles"), std::string::npos);
}

TEST_F(PaperFigures, RingTheBestGainThatASearchOfItsOwnFinds) {
  // The best point is the one that a search of its own finds.
  const fs::path found = in_folder("best.json");
  ASSERT_EQ(nuno({"optimize", scene("s-curve-32"), "--out", found}).status, 0);
  char best[64];
  std::snprintf(best, sizeof best, "best, both engines: α = %.3g N/m",
                read_json(found)["alpha"].get<double>());
  EXPECT_NE(figure(5).find(best), std::string::npos) << best;
  // It is where the curve is lowest, and ringed.
  const std::vector<Places> curves = polylines(figure(5), "a thick");
  ASSERT_EQ(curves.size(), 2u) << "its key and the curve";
  const auto lowest =
      std::ranges::max(curves[1], {}, [](const auto& place) { return place[1]; });  // y is down
  const std::string ring = "<circle class=\"line a\"";
  ASSERT_NE(figure(5).find(ring), std::string::npos);
  const std::vector<double> ringed = numbers(figure(5).substr(figure(5).find(ring)));
  EXPECT_LT(distance(lowest, {ringed[0], ringed[1]}), 4) << "a few of the scan's steps";
}

TEST_F(PaperFigures, DrawFlightsToScale) {
  // An error measured on the paper is the one in the text.
  for (const auto& [n, percent] : std::vector<std::pair<int, double>>{{6, 8.85}, {7, 2.17}}) {
    const std::vector<Places> targets = polylines(figure(n), "band");
    const std::vector<Places> finals = polylines(figure(n), "a  thick");
    ASSERT_EQ(targets.size(), 2u) << "the flight and the arrival, enlarged";
    ASSERT_EQ(finals.size(), 2u);
    for (const std::size_t plot : {0u, 1u}) {
      double sum = 0, length = 0;
      for (std::size_t i = 0; i < 32; ++i) {
        sum += distance(targets[plot].at(i), finals[plot].at(i));
        if (i > 0) length += distance(targets[plot][i - 1], targets[plot][i]);
      }
      EXPECT_NEAR(100 * sum / 32 / length, percent, 0.02) << "hundredths of a pixel";
    }
  }
}

TEST_F(Pictures, AStillAndAMovingSvgOfSeveralResultsAreWellFormed) {
  const std::string native = result("native"), box2d = result("box2d");
  using Words = std::vector<std::string>;
  for (const Words& more :
       {Words{}, {"--still"}, {"--plain"}, {"--plain", "--still"}, {"--speed", "0.25"}}) {
    const fs::path file = in_folder("out.svg");
    Words words = {"render", native, box2d, "--out", file};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome made = nuno(words);
    EXPECT_EQ(made.status, 0) << made.err;
    const std::string svg = read_text(file);
    EXPECT_TRUE(is_svg(svg)) << testing::PrintToString(more) << ": " << xml_mistake(svg);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    const auto has = [&](const char* word) { return std::ranges::find(more, word) != more.end(); };
    EXPECT_NE(svg.find("<animate") != std::string::npos, has("--still"));
    if (!has("--plain")) {
      EXPECT_NE(svg.find("throw &lt;&amp;&gt;"), std::string::npos);
      EXPECT_NE(svg.find("Box2D"), std::string::npos);
    }
  }
}

TEST_F(Pictures, AFilmHasAllItsFramesAndLastsAsLongAsTheFlightAndARest) {
  for (const std::string program : {"ffmpeg", "ffprobe"}) {
    if (!is_installed(program)) GTEST_SKIP() << program << " is not installed";
  }
  const std::string file = result();
  constexpr double shown = 0.5 + 1.5;  // flight, rest at arrival [s]
  for (const auto& [extension, rate] :
       std::vector<std::pair<std::string, int>>{{"mp4", 60}, {"gif", 25}, {"webm", 60}}) {
    const std::string film = in_folder("film." + extension).string();
    const Outcome made = nuno({"render", file, "--out", film});
    ASSERT_EQ(made.status, 0) << made.err;
    const Outcome probe =
        run("ffprobe -v error -select_streams v -count_frames -show_entries "
            "stream=nb_read_frames,width,height:format=duration -of json " +
            word(film));
    ASSERT_EQ(probe.status, 0) << probe.err;
    const Json found = Json::parse(probe.out);
    const Json stream = found["streams"][0];
    EXPECT_EQ(std::stoi(stream["nb_read_frames"].get<std::string>()), std::lround(shown * rate))
        << extension;
    EXPECT_NEAR(std::stod(found["format"]["duration"].get<std::string>()), shown, 1.0 / rate)
        << extension;
    EXPECT_EQ(stream["width"], extension == "gif" ? 800 : 1600);
    if (extension != "gif") continue;  // the others lose digits: no two pictures are the same
    const Outcome pictures = run("ffmpeg -v error -i " + word(film) + " -f framemd5 -");
    ASSERT_EQ(pictures.status, 0) << pictures.err;
    std::set<std::string> different;
    std::istringstream lines(pictures.out);
    for (std::string line; std::getline(lines, line);) {
      if (!line.starts_with("#")) different.insert(line.substr(line.rfind(',')));
    }
    // Every moment of the flight is another picture; at rest all are one.
    EXPECT_EQ(different.size(), std::ceil(0.5 * rate) + 1);
  }
}

TEST_F(Pictures, AFilmIsThereWholeOrNotAtAll) {
  if (!is_installed("ffmpeg")) GTEST_SKIP() << "ffmpeg is not installed";
  const std::string file = result();
  for (const std::string extension : {"mp4", "gif", "webm"}) {
    const std::string film = output("film." + extension).string();
    write_text(film, "precious");
    const std::string render =
        "exec " NUNO_PROGRAM " render " + word(file) + " --out " + word(film);
    // The disk is full after a few kilobytes.
    const Outcome full = run("trap '' XFSZ; ulimit -f 8; " + render);
    EXPECT_EQ(full.status, 1) << extension;
    EXPECT_EQ(std::ranges::count(full.err, '\n'), 1) << full.err;
    EXPECT_EQ(read_text(film), "precious");
    // Ended by a signal to it alone, at a speed at which the film takes long.
    const Process process({"render", file, "--speed", "0.01", "--out", film}, in_folder("stdout"),
                          in_folder("stderr"));
    std::this_thread::sleep_for(500ms);
    process.send(SIGTERM);
    EXPECT_EQ(process.wait(), -SIGTERM);
    EXPECT_EQ(read_text(film), "precious");
    EXPECT_EQ(outputs(), std::set<std::string>{"film." + extension});
    EXPECT_EQ(run(render + " <&-").status, 0) << "standard input is closed";
    EXPECT_GT(fs::file_size(film), 10'000u);
    fs::remove(film);
  }
}

TEST_F(Pictures, WithoutItsProgramsAFilmSaysWhatToInstall) {
  const std::string film = in_folder("film.mp4").string();
  const Outcome made =
      run("PATH=/nowhere " NUNO_PROGRAM " render " + word(result()) + " --out " + word(film));
  EXPECT_EQ(made.status, 1);
  EXPECT_NE(made.err.find("apt-get install"), std::string::npos) << made.err;
  EXPECT_EQ(std::ranges::count(made.err, '\n'), 1) << made.err;
  EXPECT_FALSE(fs::exists(film));
}

TEST_F(Pictures, ABadResultIsRefusedInOneLineThatSaysWhereAndWhy) {
  const Json right = read_json(result());
  struct Bad {
    std::string pointer;
    Json value;
    std::string message;
  };
  for (const Bad& bad : std::vector<Bad>{
           {"/nuno_result", 2, "/nuno_result: 2 is not 1"},
           {"/alpha", "much", "/alpha: \"much\" is not a number"},
           {"/alpha", -1, "/alpha: -1 is not >= 0"},
           {"/cloth_length", 0, "/cloth_length: 0 is not > 0"},
           {"/cloth_length", 1e-300, "/cloth_length: 1e-300 is not >= 1e-12"},
           {"/alpha", 1e16, "/alpha: 1e+16 is not within"},
           {"/target", 3, "/target: 3 is not a list"},
           {"/target", Json(std::vector(8, std::array{1.0, 2.0})),
            "/target: an extent of 0 is not"},
           {"/target/1", {1, 2, 3}, "/target/1: [1,2,3] is not a point [x, y]"},
           {"/final/2/0", nullptr, "/final/2/0: null is not a number"},
           {"/frames/times/1", 0, "/frames/times/1: 0 is not later than the frame before"},
           {"/frames/times", {0, 1}, "/frames/positions: "},
           {"/frames/positions/3", {{0, 1}, {1, 1}}, "/frames/positions/3: 2 points are not 8"},
           {"/frames/positions/3/1/1", 1e300, "/frames/positions/3/1/1: 1e+300 is not within"},
           {"/error", Json::array(), "/error: [] is not an object"},
       }) {
    Json wrong = right;
    wrong[Json::json_pointer(bad.pointer)] = bad.value;
    const std::string file = in_folder("bad.json");
    write_text(file, wrong.dump());
    const Outcome made = nuno({"render", file, "--out", in_folder("bad.svg")});
    EXPECT_EQ(made.status, 2) << bad.message;
    EXPECT_TRUE(made.err.starts_with(file + ": " + bad.message)) << made.err;
    EXPECT_EQ(std::ranges::count(made.err, '\n'), 1) << made.err;
  }
  for (const std::string text : {"", "{", "[]",
                                 "\x7f"
                                 "ELF"}) {
    const std::string file = in_folder("bad.json");
    write_text(file, text);
    EXPECT_EQ(nuno({"render", file, "--out", in_folder("bad.svg")}).status, 2) << text;
  }
  EXPECT_FALSE(fs::exists(in_folder("bad.svg")));
}

// Where numbers lie closer together than ticks, an axis has no next tick.
TEST_F(Pictures, AResultFarFromTheOriginIsDrawnOrRefusedAtOnce) {
  Json far = read_json(result());
  const auto rendered_at = [&](double extent) {
    Json line = Json::array();
    for (int i = 0; i < 8; ++i) line.push_back({1e9, 1 + extent * i / 7});
    far["target"] = far["final"] = line;
    for (Json& positions : far["frames"]["positions"]) positions = line;
    const std::string file = in_folder("far.json");
    write_text(file, far.dump());
    return run("ulimit -v 4000000; exec timeout 20 " NUNO_PROGRAM " render " + word(file) +
               " --out " + word(in_folder("far.svg")));
  };
  const Outcome refused = rendered_at(1e-7);
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_NE(refused.err.find("/target: an extent of "), std::string::npos) << refused.err;
  const Outcome drawn = rendered_at(2);
  EXPECT_EQ(drawn.status, 0) << drawn.err;
  EXPECT_LT(fs::file_size(in_folder("far.svg")), 1'000'000u);
}

TEST_F(Pictures, TheReadmesPictureIsWhatItsCommandMakes) {
  const fs::path fresh = in_folder("nuno.svg");
  const Outcome made = nuno({"render", scene("nuno/n1"), scene("nuno/n2"), scene("nuno/o"),
                             scene("nuno/u"), "--plain", "--out", fresh});
  ASSERT_EQ(made.status, 0) << made.err;
  const std::string svg = read_text(fresh);
  EXPECT_TRUE(is_svg(svg)) << xml_mistake(svg);
  const std::vector<double> now = numbers(svg);
  const std::vector<double> then = numbers(read_text(NUNO_DOCS "/nuno.svg"));
  ASSERT_EQ(now.size(), then.size());
  double most = 0;
  for (std::size_t i = 0; i < now.size(); ++i) most = std::max(most, std::abs(now[i] - then[i]));
  EXPECT_LE(most, 0.5) << "pixels: another machine may round otherwise, an eye sees no half pixel";
}

}  // namespace
}  // namespace nuno

// nuno batch, and the scheduling below it: each shot once, the same bits whoever makes it when.

#include <nuno/batch.h>
#include <nuno/scene_file.h>

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "program.h"
#include "scene_library.h"

namespace nuno {
namespace {

TEST(RunBatch, WorksOnEachOnceAndFinishesItOnTheCallingThread) {
  const auto here = std::this_thread::get_id();
  std::vector<int> worked(100), finished(100);
  run_batch(100, 3, [&](Index number, const std::stop_token&) {
    const auto i = static_cast<std::size_t>(number);
    ++worked[i];
    return [&, i] {
      EXPECT_EQ(std::this_thread::get_id(), here);
      ++finished[i];
    };
  });
  EXPECT_EQ(worked, std::vector<int>(100, 1));
  EXPECT_EQ(finished, std::vector<int>(100, 1));
}

TEST(RunBatch, GivesAnExceptionOnceTheOthersAreStopped) {
  for (const bool in_work : {true, false}) {
    std::atomic<int> worked = 0;
    const auto work = [&](Index i, const std::stop_token& stop) {
      ++worked;
      if (i == 5 && in_work) throw std::runtime_error("five");
      while (i == 6 && !stop.stop_requested()) std::this_thread::yield();  // until it is stopped
      return [i] {
        if (i == 5) throw std::runtime_error("five");
      };
    };
    EXPECT_THROW(run_batch(100'000, 2, work), std::runtime_error);
    EXPECT_LT(worked, 100'000);
  }
}

class Batch : public Program {
 protected:
  Batch() { fs::create_directory(in_folder("shots")); }

  std::string shot(const std::string& name) const { return in_folder("shots") / (name + ".json"); }

  void write_family(int count) const {
    for (const ChainScene& scene : scene_library::family(count)) {
      write_text(shot(scene.name), to_json(scene));
    }
  }

  std::vector<std::string> words(const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> all = {"batch", in_folder("shots"), "--out", in_folder(out)};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }

  Outcome batch(const std::string& out, const std::vector<std::string>& more = {}) {
    return nuno(words(out, more));
  }

  /// All files below a folder, by their paths.
  std::map<std::string, std::string> files(const std::string& folder) const {
    std::map<std::string, std::string> result;
    for (const auto& entry : fs::recursive_directory_iterator(in_folder(folder))) {
      if (entry.is_directory()) continue;
      result[fs::relative(entry.path(), in_folder(folder))] =
          without_seconds(read_text(entry.path()));
    }
    return result;
  }

  /// The summary without the column of the shots' paths and the heading.
  std::vector<std::string> states(const std::string& out) const {
    std::vector<std::string> result;
    std::istringstream csv(read_text(in_folder(out) / "summary.csv"));
    std::string line;
    std::getline(csv, line);
    while (std::getline(csv, line)) {
      const std::size_t start = line.find(',') + 1;
      result.push_back(line.substr(start, line.find(',', start) - start));
    }
    return result;
  }
};

TEST_F(Batch, MakesTheSameBitsWhateverTheJobsAndTheParts) {
  write_family(16);
  write_text(shot("sheet"),
             R"({"nuno_scene": 1, "arrival_time": 0.2, "reference": "morph",)"
             R"("initial": ")" NUNO_TEST_DATA R"(/sheets/textured-strip-start.obj",)"
             R"("target": ")" NUNO_TEST_DATA R"(/sheets/textured-strip-target.obj"})");
  const Outcome one = batch("one", {"--jobs", "1"});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_TRUE(one.out.starts_with("17 shots: 17 thrown\n")) << one.out;
  const auto wanted = files("one");
  EXPECT_EQ(wanted.size(), 2 * 17u + 2);  // results and pictures, summary and report
  EXPECT_EQ(states("one"), std::vector<std::string>(17, "ok"));

  ASSERT_EQ(batch("two", {"--jobs", "2"}).status, 0);
  EXPECT_EQ(files("two"), wanted);

  for (const char* part : {"3/3", "1/3", "2/3"}) {
    EXPECT_EQ(batch("parts", {"--part", part, "--jobs", "3"}).status, 0);
  }
  EXPECT_EQ(files("parts").size(), 17u);
  EXPECT_TRUE(batch("parts").out.starts_with("17 shots: 0 thrown, 17 were there\n"));
  EXPECT_EQ(files("parts"), wanted);

  const std::string name = scene_library::family(1).front().name;
  ASSERT_EQ(nuno({"optimize", shot(name), "--out", output("a.json")}).status, 0);
  EXPECT_EQ(without_seconds(read_text(output("a.json"))), wanted.at(name + ".json"));
}

TEST_F(Batch, GoesOnWhereItWasInterrupted) {
  write_family(8);
  const auto start = std::chrono::steady_clock::now();
  ASSERT_EQ(batch("whole").status, 0);
  const std::chrono::duration<double> whole = std::chrono::steady_clock::now() - start;
  const auto wanted = files("whole");

  std::mt19937 random(3);
  std::uniform_real_distribution<double> moment(0, 0.5 * whole.count());
  constexpr std::array signals = {SIGTERM, SIGKILL, SIGINT};
  const int kills = wished("NUNO_MOMENTS", 4);
  std::map<std::string, fs::file_time_type> made;  // when the results that are there were
  int ended = 0;
  for (int i = 0; i < kills; ++i) {
    const int signal = signals[static_cast<std::size_t>(i) % signals.size()];
    const Process process(words("out", {}), in_folder("stdout"), in_folder("stderr"));
    std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
    process.send(signal);
    ended += process.wait() == -signal;
    if (!fs::exists(in_folder("out"))) continue;
    for (const auto& [name, text] : files("out")) {
      if (fs::path(name).filename().string().starts_with(".nuno-") && signal == SIGKILL) {
        fs::remove(in_folder("out") / name);
      } else {
        ASSERT_TRUE(wanted.contains(name)) << name << " is left";
        EXPECT_EQ(text, wanted.at(name)) << name << " is not whole";
      }
      if (!name.ends_with(".json")) continue;
      const auto now = fs::last_write_time(in_folder("out") / name);
      EXPECT_EQ(made.emplace(name, now).first->second, now) << name << " is thrown twice";
    }
  }
  std::printf("a batch of %.2f s, killed %d times of %d, then continued\n", whole.count(), ended,
              kills);
  const Outcome last = batch("out");
  EXPECT_EQ(last.status, 0) << last.err;
  EXPECT_EQ(files("out"), wanted);
  for (const auto& [name, then] : made) {
    EXPECT_EQ(fs::last_write_time(in_folder("out") / name), then) << name << " is thrown twice";
  }
}

TEST_F(Batch, TellsBrokenAndDivergedShotsAndThrowsTheOthers) {
  write_text(shot("a"), right_scene().dump());
  write_text(
      shot("b"),
      R"({"nuno_scene": 1, "arrival_time": -1,"initial":[[0,0],[1,0]],"target":[[0,0],[1,0]]})");
  Json wild = right_scene();  // drawn 20 km long: the launch tears it
  wild["target"] = {{0, 0}, {20'000, 0}};
  wild["target_length"] = "as-drawn";
  write_text(shot("c"), wild.dump());
  write_text(shot("d"), right_scene().dump());
  const Outcome run = batch("out", {"--jobs", "2"});
  EXPECT_EQ(run.status, 2);
  EXPECT_NE(run.err.find(shot("b") + ": /arrival_time: -1 is not > 0"), std::string::npos)
      << run.err;
  const auto found = states("out");
  ASSERT_EQ(found.size(), 4u);
  EXPECT_EQ(found[0], "ok");
  EXPECT_EQ(found[1], "broken");
  EXPECT_EQ(found[2], "diverged");
  EXPECT_EQ(found[3], "ok");
  EXPECT_TRUE(fs::exists(in_folder("out/d.json")));
  EXPECT_FALSE(fs::exists(in_folder("out/b.json")));
  EXPECT_NE(read_text(in_folder("out/report.html")).find("-1 is not &gt; 0"), std::string::npos);

  write_text(shot("b"), right_scene().dump());
  fs::remove(shot("c"));
  EXPECT_TRUE(batch("out").out.starts_with("3 shots: 1 thrown, 2 were there\n"));
}

TEST_F(Batch, ThrowsAgainWhatHasChanged) {
  Json sheet = {
      {"nuno_scene", 1}, {"arrival_time", 0.1}, {"initial", "a.obj"}, {"target", "a.obj"}};
  write_text(in_folder("shots/a.obj"), "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 3 2\n");
  write_text(shot("sheet"), sheet.dump());
  write_text(shot("chain"), right_scene().dump());
  ASSERT_EQ(batch("out").status, 0);
  const auto later = fs::last_write_time(in_folder("out/sheet.json")) + 1s;
  EXPECT_TRUE(batch("out").out.starts_with("2 shots: 0 thrown, 2 were there"));
  fs::last_write_time(in_folder("shots/a.obj"), later);
  EXPECT_TRUE(batch("out").out.starts_with("2 shots: 1 thrown, 1 were there")) << "its mesh";
  fs::last_write_time(in_folder("shots/a.obj"), later - 1h);
  fs::last_write_time(shot("chain"), later);
  EXPECT_TRUE(batch("out").out.starts_with("2 shots: 1 thrown, 1 were there")) << "its scene";
  fs::last_write_time(shot("chain"), later - 1h);
  write_text(in_folder("out/chain.json"), "{\"half\": ");
  EXPECT_TRUE(batch("out").out.starts_with("2 shots: 1 thrown, 1 were there")) << "no result";
}

TEST_F(Batch, RefusesWhatWouldLoseAResult) {
  write_text(shot("a"), right_scene().dump());
  expect_refusal(nuno({"batch", shot("a"), shot("a"), "--out", in_folder("out")}), shot("a"),
                 shot("a"), "their results would be one file");
  expect_refusal(nuno({"batch", shot("a"), "--out", in_folder("shots")}),
                 "--out: ", in_folder("shots"), "the result would take its place");
  for (const char* part : {"0/2", "3/2", "1/0", "1", "/", "a/2", ""}) {
    expect_refusal(nuno({"batch", shot("a"), "--out", in_folder("out"), "--part", part}),
                   "--part: ", "", "is not");
  }
  EXPECT_FALSE(fs::exists(in_folder("out")));
}

}  // namespace
}  // namespace nuno

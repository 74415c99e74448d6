// What the program bears: little memory, full files, signals, pipes, hostile scenes.

#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <sys/resource.h>
#include <unistd.h>

#include "program.h"

namespace nuno {
namespace {

class Pressure : public Program {
 protected:
  /// A run of a shell's command, in which $nuno is the program.
  Outcome shell(const std::string& command) const {
    const std::string err = in_folder("shell-err"), out = in_folder("shell-out");
    const std::string whole =
        "nuno=" NUNO_PROGRAM "; ( " + command + " ) >" + word(out) + " 2>" + word(err);
    const int status = std::system(whole.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_text(out),
            read_text(err)};
  }

  std::string file(const std::string& name, const std::string& text) const {
    write_text(in_folder(name), text);
    return in_folder(name);
  }

  /// Enough frames for a result of some megabytes.
  std::string scene_of_many_frames() const {
    Json scene = right_scene();
    scene["frames_per_second"] = 20000;
    return file("frames.json", scene.dump());
  }
};

std::string scene_of_points(std::size_t count) {
  std::string text = R"({"nuno_scene":1,"arrival_time":1,"target":[[0,0],[1,0]],"initial":[)";
  for (std::size_t i = 0; i < count; ++i) {
    text += (i ? ",[" : "[") + std::to_string(i) + ".125,0.12345678]";
  }
  return text + "]}";
}

TEST_F(Pressure, UnknownFieldsAreRefusedAtTheFirst) {
  std::string text = R"({"nuno_scene":1,"initial":[[0,0],[1,0]],"target":[[0,0],[1,0]])";
  for (int i = 0; i < 300'000; ++i) text += ",\"k" + std::to_string(i) + "\":0";
  const std::string scene = file("many.json", text + "}");
  const Outcome run = shell("ulimit -t 5; exec $nuno simulate " + word(scene));
  EXPECT_EQ(run.status, 2);
  EXPECT_TRUE(run.err.starts_with(scene + ": /k0: \"k0\" is not a known field")) << run.err;
}

TEST_F(Pressure, ASceneThatMemoryIsTooShortForIsRefusedByName) {
  const std::string scene = file("big.json", scene_of_points(1'000'000));
  const std::string odd = file("odd.json", R"({"name":)" + scene_of_points(1'000'000) + "}");
  std::set<int> seen;
  for (int kilobytes = 50'000; kilobytes <= 200'000; kilobytes += 50'000) {
    for (const std::string& path : {scene, odd}) {
      const Outcome run =
          shell("ulimit -v " + std::to_string(kilobytes) + "; exec $nuno simulate " + word(path));
      if (run.status == 127) continue;  // too little for the program itself
      EXPECT_TRUE(run.status == 0 || run.status == 2) << kilobytes << ": " << run.status << run.err;
      EXPECT_TRUE(run.status == 0 || run.err.starts_with(path + ": ")) << run.err;
      if (path == scene) seen.insert(run.status);
    }
  }
  EXPECT_EQ(seen, (std::set<int>{0, 2}));
}

TEST_F(Pressure, PointsAreReadWithoutAValueForEach) {
  const std::string scene = file("big.json", scene_of_points(3'000'000));
  const auto most = [](const std::string& command) {  // resident memory of it [bytes]
    (void)std::system(command.c_str());
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return 1024.0 * static_cast<double>(usage.ru_maxrss);
  };
  const double size = static_cast<double>(fs::file_size(scene));
  const double memory = most(NUNO_PROGRAM " simulate " + scene + " >/dev/null");
  std::printf("%.0f MB of points took %.0f MB\n", size / 1e6, memory / 1e6);
  EXPECT_LT(memory, 4 * size);  // the text, and the numbers thrice at most
}

TEST_F(Pressure, AFileThatMayNotGrowIsExitStatusOneAndLeavesNothing) {
  write_text(output("result.json"), "precious");
  for (const char* name : {"result.json", "new.json"}) {
    const std::string out = output(name);
    const Outcome run = shell("ulimit -f 100; exec $nuno simulate " + word(scene_of_many_frames()) +
                              " --out " + word(out));
    EXPECT_EQ(run.status, 1);
    EXPECT_TRUE(is_one_line(run.err) && run.err.starts_with(out + ": cannot be written"))
        << run.err;
  }
  EXPECT_EQ(read_text(output("result.json")), "precious");
  EXPECT_EQ(outputs(), std::set<std::string>{"result.json"});
}

TEST_F(Pressure, SignalsThatEndItLeaveNothing) {
  const std::string scene = scene_of_many_frames();
  for (const int signal : {SIGQUIT, SIGXCPU}) {
    for (int moment = 0; moment < 12; ++moment) {
      const Process process({"simulate", scene, "--out", output("result.json")},
                            in_folder("stdout"), in_folder("stderr"));
      process.wait_until_it_catches(signal);
      std::this_thread::sleep_for(moment * 20ms);
      process.send(signal);
      const int status = process.wait();
      EXPECT_TRUE(status == 0 || status == 1) << status;
      EXPECT_TRUE(status == 0 || is_one_line(read_text(in_folder("stderr"))));
      const std::set<std::string> left = outputs();
      EXPECT_TRUE(left.empty() || left == std::set<std::string>{"result.json"});
      EXPECT_TRUE(left.empty() || read_json(output("result.json"))["nuno_result"] == 1);
    }
  }
}

TEST_F(Pressure, ProcessorTimeThatRunsOutIsSaid) {
  const Outcome run = shell("ulimit -S -t 1; exec $nuno simulate " + word(scene("s-curve-32")) +
                            " --time-step 5e-8");
  EXPECT_EQ(run.status, 1);
  EXPECT_TRUE(run.err.ends_with("nuno: the processor time that is allowed has run out\n"))
      << run.err;
}

TEST_F(Pressure, RendersWhatComesThroughAPipe) {
  const std::string result = in_folder("result.json"), svg = output("a.svg");
  ASSERT_EQ(nuno({"optimize", scene("s-curve-32"), "--out", result}).status, 0);
  ASSERT_EQ(nuno({"render", result, "--still", "--out", svg}).status, 0);
  const std::string drawn = read_text(svg);
  const auto same = [&](const std::string& command) {
    fs::remove(svg);
    const Outcome run = shell(command + " --still --out " + word(svg));
    EXPECT_EQ(run.status, 0) << command << run.err;
    EXPECT_EQ(read_text(svg), drawn) << command;
  };
  same("cat " + word(result) + " | $nuno render /dev/stdin");
  same("cat " + word(result) + " | $nuno render -");
  const std::string pipe = word(in_folder("pipe"));
  same("mkfifo " + pipe + "; cat " + word(result) + " >" + pipe + " & exec $nuno render " + pipe);
  same("cat " + word(scene("s-curve-32")) + " | $nuno render -");
  const Outcome run = shell("cat " + word(scene("s-curve-32")) + " | $nuno simulate - --out -");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(shell("echo 3 | $nuno simulate -").err, "standard input: /: 3 is not an object\n");
}

TEST_F(Pressure, ASceneIsOneWhateverItsFirstField) {
  Json scene = right_scene();
  scene["arrival_time"] = 0.2;
  std::string text = scene.dump();
  text = "{\"name\":\"" + std::string(1000, 'x') + "\"," + text.substr(1);
  EXPECT_EQ(nuno({"render", file("late.json", text), "--out", output("a.svg")}).status, 0);
}

TEST_F(Pressure, AnOutputThroughALinkMakesItsFile) {
  fs::create_directory(in_folder("there"));
  fs::create_symlink("../there/new.json", output("link.json"));  // from the link's own folder
  ASSERT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("link.json")}).status, 0);
  EXPECT_TRUE(fs::is_symlink(output("link.json")));
  EXPECT_EQ(read_json(in_folder("there") / "new.json")["nuno_result"], 1);

  fs::create_symlink("loop.json", output("loop.json"));
  EXPECT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("loop.json")}).status, 1);
  fs::create_symlink("no/such/folder.json", output("nowhere.json"));
  EXPECT_EQ(nuno({"simulate", scene("s-curve-32"), "--out", output("nowhere.json")}).status, 1);
}

TEST_F(Pressure, AFileThatIsReadOnlyStays) {
  std::string as_someone;  // root may write everything
  if (geteuid() == 0) {
    if (!is_installed("setpriv")) GTEST_SKIP() << "root, and setpriv is not installed";
    as_someone = "setpriv --reuid=65534 --regid=65534 --clear-groups ";
  }
  const std::string out = output("result.json");
  write_text(out, "precious");
  fs::permissions(out, fs::perms{0444});
  fs::permissions(in_folder("outputs"), fs::perms{0777});
  fs::permissions(in_folder(""), fs::perms{0755});
  const std::string cloth = file("scene.json", right_scene().dump());
  const Outcome run =
      shell("exec " + as_someone + "$nuno simulate " + word(cloth) + " --out " + word(out));
  EXPECT_EQ(run.status, 1);
  EXPECT_EQ(run.err, out + ": cannot be written: Permission denied\n");
  EXPECT_EQ(read_text(out), "precious");
}

TEST_F(Pressure, SaysWhatLongWorkWillTake) {
  for (const char* command : {"simulate", "optimize"}) {
    const Process process({command, scene("s-curve-32"), "--time-step", "2e-8"},
                          in_folder("stdout"), in_folder("stderr"));
    const std::string told = "s-curve-32: this takes about ";
    for (int i = 0; i < 600 && read_text(in_folder("stderr")).empty(); ++i) {
      std::this_thread::sleep_for(50ms);
    }
    process.send(SIGINT);
    EXPECT_EQ(process.wait(), -SIGINT) << "it has ended before anybody could ask";
    EXPECT_TRUE(read_text(in_folder("stderr")).starts_with(told));
  }
}

TEST_F(Pressure, WithoutThreadsItWorksOnOne) {
  const std::string cloth = file("scene.json", right_scene().dump());
  const std::string best = nuno({"optimize", cloth, "--backend", "box2d"}).out;
  // Stacks that no thread can have.
  const Outcome run = shell("ulimit -v 400000; ulimit -s 4000000; exec $nuno optimize " +
                            word(cloth) + " --backend box2d");
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(run.out.substr(0, run.out.find(" rollouts in")),
            best.substr(0, best.find(" rollouts in")));
  const Outcome studio = shell(
      "ulimit -v 400000; ulimit -s 4000000; "
      "timeout 20 $nuno studio --no-open --port 0");
  EXPECT_EQ(studio.status, 1);
  EXPECT_TRUE(is_one_line(studio.err) && studio.err.find("no thread") != std::string::npos)
      << studio.err;
}

}  // namespace
}  // namespace nuno

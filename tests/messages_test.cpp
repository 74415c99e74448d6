// What is no text, or too much of it, is told in one short line of UTF-8 that names the likely
// cause, whatever the door.

#include <gtest/gtest.h>

#include <nuno/output.h>

#include <string>
#include <vector>

#include "program.h"

namespace nuno {
namespace {

class Messages : public Program {
 protected:
  /// Of one line, at most 400 bytes of UTF-8 but for the file's name; it names the cause.
  void expect_refusal_of(const std::string& name, const std::string& text,
                         const std::string& cause) const {
    const std::string file = in_folder(name).string();
    write_text(file, text);
    const bool is_json = name.ends_with(".json");
    std::vector<std::vector<std::string>> doors;
    if (is_json) {
      doors = {{"simulate", file},
               {"optimize", file},
               {"compare", file},
               {"render", file, "--out", output("film.svg")}};
    } else {
      doors = {{"throw", file, file, "--time", "1"}};
    }
    for (const auto& arguments : doors) {
      const Outcome run = nuno(arguments);
      EXPECT_EQ(run.status, 2) << arguments[0] << " " << name;
      EXPECT_TRUE(is_one_line(run.err)) << run.err;
      EXPECT_LE(run.err.size(), 401u + file.size()) << run.err;
      EXPECT_EQ(printable(run.err.substr(0, run.err.size() - 1)) + "\n", run.err);
      EXPECT_NE(run.err.find(cause), std::string::npos) << arguments[0] << " " << run.err;
    }
  }
};

/// As an editor of Windows may save it.
std::string utf16(const std::string& text, bool little = true, bool marked = true) {
  std::string result = marked ? (little ? "\xff\xfe" : "\xfe\xff") : "";
  for (const char c : text) {
    result += little ? c : '\0';
    result += little ? '\0' : c;
  }
  return result;
}

const std::vector<std::string> text_files = {"a.json", "a.obj", "a.csv", "a.svg"};

TEST_F(Messages, NameUtf16) {
  for (const std::string& name : text_files) {
    for (const bool little : {true, false}) {
      for (const bool marked : {true, false}) {
        expect_refusal_of(name, utf16(right_scene().dump(), little, marked), "UTF-16");
      }
    }
  }
}

TEST_F(Messages, NameBinaryFiles) {
  for (const std::string& name : text_files) {
    expect_refusal_of(name, std::string("\x1f\x8b\x08\0\0\0\0\0", 8), "gzip");
    expect_refusal_of(name, std::string("PK\x03\x04\x14\0\0\0", 8), "zip archive");
    expect_refusal_of(name, std::string("\x89PNG\r\n\x1a\n\0\0\0\r", 12), "PNG");
    expect_refusal_of(name,
                      std::string("\x7f"
                                  "ELF\x02\x01\x01\0\0\0",
                                  10),
                      "binary file");
  }
}

TEST_F(Messages, NameTheByteThatIsNoUtf8AndItsLine) {
  std::string latin = right_scene().dump();
  latin.insert(1, "\n\"name\": \"caf\xe9\",\n");
  expect_refusal_of("a.json", latin, "byte 0xE9 in line 2");
  expect_refusal_of("a.json", latin, "Latin-1");
}

TEST_F(Messages, CutWhatIsLong) {
  const std::string digits(3'000'000, '7');
  Json scene = right_scene();
  const auto with = [&](const std::string& old, const std::string& fresh) {
    std::string text = scene.dump();
    return text.replace(text.find(old), old.size(), fresh);
  };
  expect_refusal_of("a.json", with("0.5", digits), "");
  expect_refusal_of("a.json", with("0.5", "1." + digits + "x"), "not JSON");
  expect_refusal_of("a.json", with("0.5", "\"" + digits + "\""), "is not a number");
  expect_refusal_of("a.json", with("\"mass\"", "\"" + digits + "\""), "is not a known field");
  expect_refusal_of("a.json", with("0.1", digits), "");
  expect_refusal_of("a.json", digits, "");
  for (const char* name : {"a.obj", "a.csv"}) expect_refusal_of(name, digits + "x", "");
  expect_refusal_of("a.svg", "<svg><path d='" + digits + "x'/></svg>", "");
  expect_refusal_of("a.ply", "ply\n" + digits, "");
  expect_refusal_of("a.gltf", "{\"asset\": {\"version\": \"" + digits + "\"}}", "");
}

TEST_F(Messages, CutLongArguments) {
  const std::string digits(100'000, '7');
  const std::vector<std::string> options = {"--alpha", "--time-step", "--backend", "--" + digits};
  for (const std::string& option : options) {
    const Outcome run = nuno({"simulate", scene("s-curve-32"), option, digits});
    EXPECT_EQ(run.status, 2);
    EXPECT_TRUE(is_one_line(run.err));
    EXPECT_LE(run.err.size(), 401u);
  }
}

TEST(MessageForPeople, KeepsWhatIsShortAndBothEndsOfTheRest) {
  EXPECT_EQ(message_for_people("file: /a: é is not > 0"), "file: /a: é is not > 0");
  std::string longer = "file: /a: ";
  for (int i = 0; i < 1000; ++i) longer += "é";
  const std::string told = message_for_people(longer + " is not > 0");
  EXPECT_LE(told.size(), 400u);
  EXPECT_TRUE(told.starts_with("file: /a: é")) << told;
  EXPECT_TRUE(told.ends_with("é is not > 0")) << told;
  EXPECT_EQ(printable(told), told);
}

// ---- what people are told that they did not ask ---------------------------------------------

class Told : public Program {
 protected:
  fs::path with(const Json& fields) const {
    Json json = right_scene();
    json.update(fields);
    write_text(in_folder("scene.json"), json.dump());
    return in_folder("scene.json");
  }
};

TEST_F(Told, AStepThatIsShorterThanAskedFor) {
  const Outcome shorter = nuno({"simulate", scene("s-curve-32"), "--time-step", "0.5"});
  EXPECT_NE(shorter.out.find("not 500 ms"), std::string::npos) << shorter.out;
  const Outcome asked = nuno({"simulate", scene("s-curve-32"), "--time-step", "0.00103"});
  EXPECT_EQ(asked.out.find("time step"), std::string::npos) << asked.out;  // 971 whole steps
}

TEST_F(Told, AFileThatIsLarge) {
  // 160 MB, told before a device that takes nothing ends it.
  const Outcome large =
      nuno({"simulate", with({{"frames_per_second", 1e6}}), "--out", "/dev/full"});
  EXPECT_EQ(large.status, 1);
  EXPECT_NE(large.err.find("/frames_per_second: 1000000 makes 500000 frames"), std::string::npos)
      << large.err;
  EXPECT_EQ(nuno({"simulate", with(Json::object()), "--out", output("small.json")}).err, "");
}

TEST_F(Told, InAResultWhetherTheBestGainIsTheLargest) {
  const Json found = simulated({"optimize", with(Json::object())})["optimization"];
  EXPECT_EQ(found["at_largest_gain"], false);
  EXPECT_NE(found["reason"].get<std::string>().find("gains scanned"), std::string::npos);
}

TEST_F(Told, ATargetDrawnTheOtherWayRound) {
  const Json straight = {{"target", {{2, 1}, {2.5, 1.3}, {3, 1}}}};
  const Json reversed = {{"target", {{3, 1}, {2.5, 1.3}, {2, 1}}}};
  EXPECT_EQ(nuno({"optimize", with(straight)}).out.find("other way round"), std::string::npos);
  const Outcome told = nuno({"optimize", with(reversed)});
  EXPECT_NE(told.out.find("--reverse-target"), std::string::npos) << told.out;
  // As it says: by the option and by the scene, the cloth flies to the line from its other end.
  Json by_scene = reversed;
  by_scene["target_order"] = "reversed";
  const Json wanted = simulated({"optimize", with(straight)});
  for (const Json& flown : {simulated({"optimize", with(reversed), "--reverse-target"}),
                            simulated({"optimize", with(by_scene)})}) {
    EXPECT_NEAR(flown["error"]["mean"].get<double>(), wanted["error"]["mean"].get<double>(), 1e-9);
  }
}

TEST_F(Told, ThatASheetsTargetIsNotReversed) {
  expect_refusal(nuno({"simulate", scene("sheets/square-to-s"), "--reverse-target"}),
                 "--reverse-target: ", "square-to-s.json", "is for a chain");
}

}  // namespace
}  // namespace nuno

#pragma once

// Sheets at the program's door: what its tests share.

#include <string>
#include <vector>

#include "program.h"

namespace nuno {

/// 3 × 3 vertices on 4 quads, in the plane y = 0: vertices on lines 1 … 9, faces on 10 … 13.
inline const std::string square =
    "v 0 0 0\nv 0.5 0 0\nv 1 0 0\n"
    "v 0 0 0.5\nv 0.5 0 0.5\nv 1 0 0.5\n"
    "v 0 0 1\nv 0.5 0 1\nv 1 0 1\n"
    "f 1 4 5 2\nf 2 5 6 3\nf 4 7 8 5\nf 5 8 9 6\n";

inline std::string replaced(std::string text, const std::string& old, const std::string& fresh) {
  return text.replace(text.find(old), old.size(), fresh);
}

/// A sheet's scene of the two meshes beside it.
inline Json sheet_scene() {
  return Json::parse(R"({
    "nuno_scene": 1, "arrival_time": 0.5, "initial": "start.obj", "target": "target.obj",
    "cloth": {"areal_density": 0.15}
  })");
}

class SheetRefusal : public Program {
 protected:
  /// The command is refused with one line that begins with these words, and touches no output.
  void expect_refused(std::vector<std::string> command, const std::string& out,
                      const std::string& start, const std::string& value,
                      const std::string& rule) const {
    write_text(output(out), "precious");
    command.insert(command.end(), {"--out", output(out)});
    const Outcome run = nuno(command);
    expect_refusal(run, start, value, rule);
    EXPECT_EQ(read_text(output(out)), "precious");
    EXPECT_EQ(outputs(), std::set<std::string>{out});
    fs::remove(output(out));
  }

  void write_meshes(const std::string& start, const std::string& target) const {
    write_text(in_folder("start.obj"), start);
    write_text(in_folder("target.obj"), target);
  }

  std::vector<std::string> throw_command() const {
    return {"throw", in_folder("start.obj"), in_folder("target.obj"), "--time", "0.5"};
  }
};

}  // namespace nuno

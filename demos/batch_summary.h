#pragma once

#include <string>
#include <vector>

#include <nuno/points.h>

namespace nuno {

/// A scene of a batch, and what became of it.
struct Shot {
  std::string scene;   ///< its file
  std::string result;  ///< the file that it makes
  enum class State { waiting, thrown, kept, diverged, broken, unwritten } state = State::waiting;
  std::string reason = {};  ///< why there is no result

  bool has_result() const { return state == State::thrown || state == State::kept; }
};

/// Whether a file is a result on this engine; never throws for what is none.
bool is_result(const std::string& path, const std::string& backend);

/// Writes summary.csv and report.html, with the pictures that it shows, into `folder`. All of it is
/// from the results' files: it does not matter when and in which order they were made.
void write_batch_summary(const std::string& folder, const std::vector<Shot>& shots, Index jobs);

}  // namespace nuno

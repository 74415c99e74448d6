// Inputs that are nearly right, from a seed: none ends in a crash, a NaN or an answer that is none.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/doors.h"

namespace nuno::fuzz {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Inputs at each door; more of them with NUNO_FUZZ_INPUTS.
int inputs() {
  const char* const wished = std::getenv("NUNO_FUZZ_INPUTS");
  return wished ? std::atoi(wished) : 1200;
}

class Mutator {
 public:
  explicit Mutator(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t n) { return n == 0 ? 0 : random_() % n; }

  std::string mutated(const std::vector<std::string>& from) {
    std::string text = from[below(from.size())];
    for (std::size_t changes = 1 + below(4); changes > 0; --changes) change(text, from);
    return text;
  }

 private:
  void change(std::string& text, const std::vector<std::string>& from) {
    static constexpr std::array<std::string_view, 33> words = {"0",
                                                               "-0",
                                                               "1e308",
                                                               "1e-320",
                                                               "-1",
                                                               "1e999",
                                                               "NaN",
                                                               "null",
                                                               "true",
                                                               "\"\"",
                                                               "[",
                                                               "]",
                                                               "{",
                                                               "}",
                                                               "[[",
                                                               ",",
                                                               "\n",
                                                               "\r\n",
                                                               "\\u0000",
                                                               "\xff",
                                                               "\xc3\xa9",
                                                               "\xed\xa0\x80",
                                                               "99999999999999999999",
                                                               "2147483648",
                                                               "1/1/1/1",
                                                               "f 1 2 3\n",
                                                               "v 0 0\n",
                                                               "&alpha=1",
                                                               "%00",
                                                               "%2e%2e",
                                                               "hold",
                                                               "3",
                                                               "1e-9"};
    const std::size_t at = below(text.size() + 1);
    const std::size_t length = std::min(below(12), text.size() - at);
    switch (below(7)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(below(256));
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(at, length));
        break;
      case 3:
        text.replace(at, length, words[below(words.size())]);
        break;
      case 4:
        replace_number(text, words[below(words.size())]);
        break;
      case 5: {
        const std::string& other = from[below(from.size())];
        text = text.substr(0, at) + other.substr(below(other.size()));
        break;
      }
      default:
        if (below(8) == 0) text.resize(at);
    }
  }

  /// A whole number for another: what is let in more often.
  void replace_number(std::string& text, std::string_view by) {
    const std::size_t start = text.find_first_of("0123456789", below(text.size() + 1));
    if (start == text.npos) return;
    const std::size_t end = std::min(text.find_first_not_of("0123456789.e", start), text.size());
    text.replace(start, end - start, below(2) ? std::string(by) : std::to_string(below(100)));
  }

  std::mt19937 random_;
};

/// What is kept for a door, by the file's name.
std::map<std::string, std::string> corpus(const Door& door) {
  std::map<std::string, std::string> files;
  const auto add = [&](const std::string& folder) {
    for (const auto& entry : fs::directory_iterator(folder)) {
      std::ifstream file(entry.path(), std::ios::binary);
      files[entry.path().filename()] = {std::istreambuf_iterator<char>(file),
                                        std::istreambuf_iterator<char>()};
    }
  };
  add(std::string(NUNO_CORPUS "/") + door.name);
  if (door.enter == enter_svg) add(NUNO_TEST_DATA "/svg");
  return files;
}

class Fuzz : public testing::TestWithParam<Door> {};

TEST_P(Fuzz, AnswersWhatIsKept) {
  int right = 0;
  for (const auto& [name, input] : corpus(GetParam())) {
    const bool is_let_in = enter(GetParam(), input, 1min);  // sanitizers are slow
    if (!name.starts_with("right-")) continue;
    EXPECT_TRUE(is_let_in) << name;
    ++right;
  }
  EXPECT_GT(right, 0);
}

TEST_P(Fuzz, EndsInAnAnswerOrARefusal) {
  std::vector<std::string> from;
  for (const auto& [name, input] : corpus(GetParam())) from.push_back(input);
  int let_in = 0, slowest = 0;
  double longest = 0;
  const int count = inputs();
  for (int i = 0; i < count; ++i) {
    const std::string input = Mutator(static_cast<unsigned>(i)).mutated(from);
    const auto start = std::chrono::steady_clock::now();
    let_in += enter(GetParam(), input);
    const double took =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (took > longest) {
      longest = took;
      slowest = i;
    }
  }
  std::printf("%s: %d inputs, %d let in, the longest, %d, took %.3f s\n", GetParam().name, count,
              let_in, slowest, longest);
  EXPECT_GT(let_in, count / 100) << "inputs that all are refused at once try little";
}

/// The door's name as one of a test: SheetScene.
std::string camel(std::string_view name) {
  std::string result;
  bool begins = true;
  for (const char c : name) {
    if (c != '-') result += begins ? static_cast<char>(c - 'a' + 'A') : c;
    begins = c == '-';
  }
  return result;
}

INSTANTIATE_TEST_SUITE_P(Doors, Fuzz, testing::ValuesIn(doors),
                         [](const auto& door) { return camel(door.param.name); });

}  // namespace
}  // namespace nuno::fuzz

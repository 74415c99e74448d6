// Inputs that are nearly right, from a seed: none ends in a crash, a NaN or an answer that is none.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <string_view>

#include "fuzz/doors.h"

namespace nuno::fuzz {
namespace {

/// Inputs at each door; more of them with NUNO_FUZZ_INPUTS.
int inputs() {
  const char* const wished = std::getenv("NUNO_FUZZ_INPUTS");
  return wished ? std::atoi(wished) : 2000;
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

class Fuzz : public testing::TestWithParam<std::pair<Door, const char*>> {};

TEST_P(Fuzz, EndsInAnAnswerOrARefusal) {
  const Door door = GetParam().first;
  const auto from = seeds(door);
  for (const std::string& seed : from) enter(door, seed);
  EXPECT_TRUE(enter(door, from.front(), std::chrono::minutes(1)));  // sanitizers are slow
  int let_in = 0;
  double longest = 0;
  const int count = inputs();
  for (int i = 0; i < count; ++i) {
    const std::string input = Mutator(static_cast<unsigned>(i)).mutated(from);
    const auto start = std::chrono::steady_clock::now();
    let_in += enter(door, input);
    longest = std::max(
        longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  std::printf("%s: %d inputs, %d let in, the longest took %.3f s\n", GetParam().second, count,
              let_in, longest);
  EXPECT_GT(let_in, count / 100) << "inputs that all are refused at once try little";
}

INSTANTIATE_TEST_SUITE_P(Doors, Fuzz,
                         testing::Values(std::pair(Door::scene, "Scene"),
                                         std::pair(Door::sheet_scene, "SheetScene"),
                                         std::pair(Door::mesh, "Mesh"),
                                         std::pair(Door::result, "Result"),
                                         std::pair(Door::page_request, "PageRequest")),
                         [](const auto& door) { return door.param.second; });

}  // namespace
}  // namespace nuno::fuzz

#pragma once

#include <nuno/gains.h>

#include <CLI/App.hpp>

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

// What the commands share: how a word of the command line is read, and the options that several
// take. Each throws CLI::ValidationError, with the option, the value and the rule.

namespace nuno {

/// A finite number, to its last bit.
double number(const std::string& option, const std::string& text);

/// A number > 0.
double positive_number(const std::string& option, const std::string& text);

/// A number ≥ 0.
double non_negative_number(const std::string& option, const std::string& text);

/// A whole number within `least` … `most`.
int whole_number(const std::string& option, const std::string& text, int least, int most);

/// One of `words`.
std::string word(const std::string& option, const std::string& text,
                 std::span<const std::string_view> words);

/// A name of a file or folder: anything but "".
std::string not_empty(const std::string& option, const std::string& text);

/// Numbers ≥ 0 with commas between them, a gain for every group.
Gains gains(const std::string& option, const std::string& text);

// The options write what they read into a variable that outlives the parsing.

/// A required argument that names a file.
void add_file(CLI::App& command, const char* name, std::string& into, const char* description);

/// A required list of arguments that name files or folders.
void add_files(CLI::App& command, const char* name, std::vector<std::string>& into,
               const char* description);

/// --backend NAME, one of `names`.
void add_backend(CLI::App& command, std::string& backend, std::span<const std::string_view> names,
                 const std::string& description);

/// --time-step H.
void add_time_step(CLI::App& command, std::optional<double>& time_step);

/// --out, a file or a folder.
void add_out(CLI::App& command, std::string& out, const char* type, const std::string& description);

/// An option whose value is a number > 0.
void add_positive(CLI::App& command, const char* name, const char* type, double& into,
                  const char* description);

/// Throws for a flag with a value: CLI11 would let some pass.
void require_bare_flags(const CLI::App& app, int argc, char** argv);

/// What was wrong with the command line, in the words of all our messages.
std::string explain(const CLI::App& app, const CLI::ParseError& error);

}  // namespace nuno

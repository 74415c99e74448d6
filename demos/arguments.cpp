#include "arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

namespace nuno {

double number(const std::string& option, const std::string& text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || rest != end || !std::isfinite(value)) {
    throw CLI::ValidationError(option, fmt::format("\"{}\" is not a finite number", text));
  }
  return value + 0.0;  // -0 is 0
}

double positive_number(const std::string& option, const std::string& text) {
  const double value = number(option, text);
  if (!(value > 0)) throw CLI::ValidationError(option, fmt::format("{} is not > 0", text));
  return value;
}

double non_negative_number(const std::string& option, const std::string& text) {
  const double value = number(option, text);
  if (!(value >= 0)) throw CLI::ValidationError(option, fmt::format("{} is not >= 0", text));
  return value;
}

int whole_number(const std::string& option, const std::string& text, int least, int most) {
  const double value = number(option, text);
  if (!(value >= least && value <= most && value == std::floor(value))) {
    throw CLI::ValidationError(
        option, fmt::format("{} is not a whole number within {} … {}", text, least, most));
  }
  return static_cast<int>(value);
}

std::string word(const std::string& option, const std::string& text,
                 std::span<const std::string_view> words) {
  if (std::ranges::find(words, text) == words.end()) {
    throw CLI::ValidationError(
        option, fmt::format("\"{}\" is not one of {}", text, fmt::join(words, ", ")));
  }
  return text;
}

std::string not_empty(const std::string& option, const std::string& text) {
  if (text.empty()) throw CLI::ValidationError(option, "\"\" is not a name");
  return text;
}

Gains gains(const std::string& option, const std::string& text) {
  std::vector<double> groups;
  for (std::size_t start = 0; start <= text.size();) {
    const std::size_t end = std::min(text.find(',', start), text.size());
    groups.push_back(non_negative_number(option, text.substr(start, end - start)));
    start = end + 1;
  }
  if (static_cast<Index>(groups.size()) > most_groups) {
    throw CLI::ValidationError(option,
                               fmt::format("\"{}\" is more than {} gains", text, most_groups));
  }
  return Gains::of_groups(groups);
}

void add_file(CLI::App& command, const char* name, std::string& into, const char* description) {
  command
      .add_option_function<std::string>(
          name, [name, &into](const std::string& text) { into = not_empty(name, text); },
          description)
      ->type_name("")
      ->required();
}

void add_files(CLI::App& command, const char* name, std::vector<std::string>& into,
               const char* description) {
  command
      .add_option_function<std::vector<std::string>>(
          name,
          [name, &into](const std::vector<std::string>& texts) {
            for (const auto& text : texts) into.push_back(not_empty(name, text));
          },
          description)
      ->type_name("")
      ->required();
}

void add_backend(CLI::App& command, std::string& backend, std::span<const std::string_view> names,
                 const std::string& description) {
  command
      .add_option_function<std::string>(
          "--backend",
          [&backend, names](const std::string& text) { backend = word("--backend", text, names); },
          description)
      ->type_name("NAME")
      ->default_str(backend);
}

void add_time_step(CLI::App& command, std::optional<double>& time_step) {
  command
      .add_option_function<std::string>(
          "--time-step",
          [&time_step](const std::string& text) {
            time_step = positive_number("--time-step", text);
          },
          "Time step [s], > 0; by default the scene's or the engine's")
      ->type_name("H");
}

void add_out(CLI::App& command, std::string& out, const char* type,
             const std::string& description) {
  command
      .add_option_function<std::string>(
          "--out", [&out](const std::string& text) { out = not_empty("--out", text); }, description)
      ->type_name(type);
}

void add_positive(CLI::App& command, const char* name, const char* type, double& into,
                  const char* description) {
  command
      .add_option_function<std::string>(
          name, [name, &into](const std::string& text) { into = positive_number(name, text); },
          description)
      ->type_name(type);
}

std::string explain(const CLI::App& app, const CLI::ParseError& error) {
  std::string what = error.what();
  if (dynamic_cast<const CLI::ExtrasError*>(&error)) {
    const std::string extra = app.remaining(true).front();
    if (extra.starts_with("-")) return fmt::format("{}: is not a known option", extra);
    if (app.get_subcommands().empty()) {
      std::vector<std::string> names;
      for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
        names.push_back(command->get_name());
      }
      return fmt::format("nuno: \"{}\" is not one of {}", extra, fmt::join(names, ", "));
    }
    return fmt::format("\"{}\": is one argument too many", extra);
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error)) {
    return what.substr(0, what.find(' ')) + ": is missing; it is required";
  }
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error)) {
    return what.substr(0, what.find(':')) + ": takes exactly one value";
  }
  return what;
}

void require_bare_flags(const CLI::App& app, int argc, char** argv) {
  std::vector<const CLI::App*> apps = app.get_subcommands([](const CLI::App*) { return true; });
  apps.push_back(&app);
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    const std::string name = argument.substr(0, argument.find('='));
    if (name.size() == argument.size() || !name.starts_with("-")) continue;
    for (const CLI::App* each : apps) {
      const CLI::Option* option = each->get_option_no_throw(name);
      if (option && option->get_items_expected_max() == 0) {
        throw CLI::ValidationError(name, "takes no value");
      }
    }
  }
}

}  // namespace nuno

#pragma once

#include <string>
#include <vector>

#include "machine.h"
#include "measure.h"

namespace nuno::bench {

/// Collects what is measured, prints it section by section, and writes it as CSV and JSON.
class Report {
 public:
  explicit Report(Machine machine) : machine_(std::move(machine)) {}

  /// A section begins; `note` says exactly what is compared.
  void begin(std::string section, std::string note);
  /// A check that holds is printed; one that does not throws Refusal.
  void check(bool holds, const std::string& what);
  /// One number: a row of the section's table is a name, a column is a quantity.
  void add(const std::string& name, const std::string& quantity, const std::string& unit,
           const Statistics& value);
  void end();  ///< prints the section's table

  /// A ratio that has a name of its own in bench.json.
  void add_ratio(std::string key, const Statistics& value);
  void print_ratios() const;

  std::string csv() const;
  std::string json() const;

 private:
  struct Measurement {
    std::string section, name, quantity, unit;
    Statistics value;
  };
  struct Ratio {
    std::string key;
    Statistics value;
  };
  Machine machine_;
  std::string section_;
  std::vector<Measurement> measurements_;
  std::vector<Ratio> ratios_;
  std::vector<std::string> checks_;
};

}  // namespace nuno::bench

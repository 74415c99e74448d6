#pragma once

#include <nuno/backend.h>

#include <memory>
#include <vector>

#include "paper_procedure.h"

namespace nuno::bench {

/// E at a few gains, as the limit of small steps has it.
class Convergence {
 public:
  /// Up to the best gain of the problem of `native`, an engine whose step is about right.
  explicit Convergence(const Backend& native);

  double off(const Backend& backend) const;   ///< largest |E − limit| [m]
  double off(const PlainChain& chain) const;  ///< the same
  double error(double gain) const;            ///< the limit of E [m]
  /// How well the limit itself is known: its change when its steps double [m].
  double uncertainty() const { return uncertainty_; }

 private:
  std::unique_ptr<Backend> limit_;
  std::vector<double> gains_;
  std::vector<double> errors_;
  double uncertainty_ = 0;
};

}  // namespace nuno::bench

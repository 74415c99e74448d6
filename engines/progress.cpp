#include <nuno/progress.h>

#include <nuno/conditioning.h>
#include <nuno/launch.h>
#include <nuno/output.h>

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <stop_token>
#include <system_error>

#include "long_work.h"

namespace nuno {

namespace {

using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// What a flight will take [s], from a few of its steps; 0 where that is not worth to be measured.
double seconds_of_flight(const Backend& backend) {
  constexpr double short_work = 1e6;  // particle-steps
  constexpr double measured = 0.02;   // seconds
  const Cloth& cloth = backend.cloth();
  const auto steps = static_cast<double>(backend.steps());
  if (steps * static_cast<double>(cloth.particles()) < short_work) return 0;
  const auto flight = backend.start(launch(backend));
  const Points forces = Points::Zero(cloth.dimension(), cloth.particles());
  const auto start = Clock::now();
  Index done = 0;
  while (done < backend.steps() && seconds_since(start) < measured) {
    flight->step(forces);
    ++done;
  }
  return seconds_since(start) * steps / static_cast<double>(done);
}

void tell(std::stop_token stop, const std::string& announcement, const std::string& label,
          double expected) {
  std::mutex mutex;
  std::condition_variable_any ended;
  std::unique_lock lock(mutex);
  const auto goes_on_for = [&](std::chrono::seconds time) {
    return !ended.wait_for(lock, stop, time, [&] { return stop.stop_requested(); });
  };
  tell_of_long_work(announcement, label, expected, goes_on_for, note);
}

}  // namespace

void tell_of_long_work(const std::string& announcement, const std::string& label, double expected,
                       const std::function<bool(std::chrono::seconds)>& goes_on_for,
                       const std::function<void(const std::string&)>& say) {
  constexpr std::chrono::seconds settled(2), pause(30);  // what diverges, mostly does at once
  if (!goes_on_for(settled)) return;
  say(announcement);
  for (auto taken = settled + pause; goes_on_for(pause); taken += pause) {
    say(fmt::format("{}: {} s of about {:.0f}", label, taken.count(), expected));
  }
}

LongWork::LongWork(const Backend& backend, const std::string& label, double flights) {
  constexpr double patience = 10;  // seconds in which nobody asks
  const double expected = flights * seconds_of_flight(backend);
  if (!(expected > patience)) return;
  const std::string announcement =
      fmt::format("{}: this takes about {:.0f} s on {}", label, expected, backend.name());
  const SignalsHeld by_the_teller;  // or one would end the program while a file is written
  try {
    teller_ = std::jthread(tell, announcement, label, expected);
  } catch (const std::system_error&) {  // the machine has no thread for it
    note(announcement);
  }
}

double flights_of_search(const Backend& backend) {
  // Some hundred gains over all cores; with derivatives, several of them at the price of one.
  const double gains = backend.has_derivatives() ? 30 : 100;
  return gains / std::max(1u, std::thread::hardware_concurrency());
}

void report_divergence(const std::string& scene_path, const Backend& backend,
                       const Rollout& rollout) {
  complain(divergence_message(scene_path, backend, rollout));
}

namespace {

/// The function `of` many gains at once, if there is one, which counts them for a person.
template <typename Answers, typename Gain>
void count_rollouts(std::function<Answers(std::span<const Gain>)>& of,
                    const std::shared_ptr<std::size_t>& count, const std::string& label) {
  if (!of) return;
  of = [count, label, of](std::span<const Gain> gains) {
    *count += gains.size();
    show_progress(fmt::format("{}: {} rollouts", label, *count));
    return of(gains);
  };
}

}  // namespace

Objective with_progress(Objective objective, const std::string& label) {
  const auto count = std::make_shared<std::size_t>(0);
  count_rollouts(objective.errors, count, label);
  count_rollouts(objective.samples, count, label);
  return objective;
}

JointObjective with_progress(JointObjective objective, const std::string& label) {
  const auto count = std::make_shared<std::size_t>(0);
  count_rollouts(objective.errors, count, label);
  count_rollouts(objective.samples, count, label);
  return objective;
}

}  // namespace nuno

// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "course.h"
#include "course_pool.h"

namespace nonio::model {

namespace {

// docs/dev/constants.md, M45.
constexpr double small_loss = 1.1, known_well = 0.1;

/// The columns of each term, and the RMS of the cross-validation of any choice of terms.
class Terms {
 public:
  Terms(const Part& part, const std::vector<Term>& terms)
      : data_(part), pool_(data_, noise_of_fit(data_)) {
    for (const Term& term : terms) {
      const auto columns = term.effect->columns(part.table, term.axis, term.shape);
      columns_.push_back(columns ? pool_.add(data_.means(*columns), quantities_of(term))
                                 : std::vector<Index>{});
    }
    pool_.finish();
    sides_.emplace(pool_, data_.displacements().leftCols(1));
  }

  double rms(const std::vector<bool>& with) const {
    std::vector<Index> columns;
    for (std::size_t t = 0; t < columns_.size(); ++t)
      if (with[t]) columns.insert(columns.end(), columns_[t].begin(), columns_[t].end());
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    return pool_.left_out(columns, *sides_, 0);
  }
  double duration() const { return data_.duration(); }

 private:
  CourseData data_;
  CoursePool pool_;
  std::vector<std::vector<Index>> columns_;
  std::optional<CourseSides> sides_;
};

class Worth {
 public:
  Worth(const Part& part, const Fit& fit) : part_(part), fit_(fit), terms_(part, fit.terms) {
    for (const Term& term : fit.terms) {
      of_term_.push_back(channels_of(term, part.table));
      for (const std::string& name : of_term_.back())
        if (std::find(channels_.begin(), channels_.end(), name) == channels_.end())
          channels_.push_back(name);
    }
  }

  std::optional<Sensors> sensors() {
    if (channels_.empty()) return std::nullopt;
    out_.recorded = part_.table.channels.size();
    out_.rms = terms_.rms(with(channels_));
    for (const std::string& channel : channels_)
      out_.used.push_back({channel, terms_.rms(with(but(channels_, channel)))});
    std::stable_sort(out_.used.begin(), out_.used.end(),
                     [](const auto& a, const auto& b) { return a.rms_without > b.rms_without; });
    smallest();
    unseen();
    duration();
    return std::move(out_);
  }

 private:
  static std::vector<std::string> but(std::vector<std::string> all, const std::string& one) {
    std::erase(all, one);
    return all;
  }

  /// Selects the terms whose channels are all in `channels`, and the terms that need none.
  std::vector<bool> with(const std::vector<std::string>& channels) const {
    std::vector<bool> out;
    for (const auto& of : of_term_)
      out.push_back(std::all_of(of.begin(), of.end(), [&](const std::string& name) {
        return std::find(channels.begin(), channels.end(), name) != channels.end();
      }));
    return out;
  }

  /// Removes the channel whose removal increases the RMS least, as long as the loss is small.
  void smallest() {
    out_.smallest = channels_;
    out_.rms_smallest = out_.rms;
    while (out_.smallest.size() > 1) {
      double least = std::numeric_limits<double>::infinity();
      std::vector<std::string> best;
      for (const std::string& channel : out_.smallest)
        if (const double rms = terms_.rms(with(but(out_.smallest, channel))); rms < least)
          least = rms, best = but(out_.smallest, channel);
      if (!(least <= small_loss * out_.rms)) break;
      out_.smallest = best;
      out_.rms_smallest = least;
    }
  }

  /// Finds a speed or load that acts through a part without a temperature sensor: its effect has a
  /// time constant, and the RMS without it is larger by more than a tenth.
  void unseen() {
    for (const Sensors::One& one : out_.used) {
      const auto* channel = part_.table.channel(one.channel);
      if (channel->is_temperature() || !(one.rms_without > small_loss * out_.rms)) continue;
      for (std::size_t t = 0; t < fit_.terms.size(); ++t)
        if (of_term_[t] == std::vector<std::string>{one.channel} && !fit_.terms[t].shape.empty()) {
          out_.unseen = one.channel;
          out_.unseen_tau = fit_.terms[t].shape.front();
          return;
        }
    }
  }

  void duration() {
    out_.measured = terms_.duration();
    for (const Parameter& p : fit_.parameters) {
      if (p.shape || !(std::fabs(p.value) > 0.0)) continue;
      if (const double relative = p.u / std::fabs(p.value); relative > out_.relative_u)
        out_.relative_u = relative, out_.weakest = p.effect;
    }
    const double factor = std::max(1.0, out_.relative_u / known_well);
    out_.wanted = out_.measured * factor * factor;
  }

  const Part& part_;
  const Fit& fit_;
  Terms terms_;
  std::vector<std::vector<std::string>> of_term_;
  std::vector<std::string> channels_;
  Sensors out_;
};

}  // namespace

std::vector<std::string> channels_of(const Term& term, const Observations& o) {
  const std::string& name = term.axis.name;
  if (o.channel(name) != nullptr) return {name};
  const std::size_t dash = name.find('-');
  if (dash == std::string::npos || o.channel(name.substr(0, dash)) == nullptr ||
      o.channel(name.substr(dash + 1)) == nullptr)
    return {};
  return {name.substr(0, dash), name.substr(dash + 1)};
}

std::optional<Sensors> sensors_of(const Part& part, const Fit& fit) {
  return Worth(part, fit).sensors();
}

}  // namespace nonio::model

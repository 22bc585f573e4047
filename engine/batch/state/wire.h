// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <concepts>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "campaign/config/site_files.h"
#include "campaign/config/site_logs.h"
#include "campaign/evaluation/evaluate.h"
#include "certificates/register.h"
#include "laboratory/assessment/history_so_far.h"
#include "laboratory/store/store.h"
#include "nonio/sdk/history.h"
#include "nonio/sdk/plugin.h"

/// Values as bytes, between two processes of one program: numbers bit by bit. What comes from a
/// process with plugins is read with a look at its length, never trusted.
namespace nonio::batch::wire {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class Writer {
 public:
  template <class... T>
  void operator()(const T&... values) {
    (put(values), ...);
  }
  std::string take() { return std::move(out_); }

 private:
  void bytes(const void* from, std::size_t size) {
    if (size != 0) out_.append(static_cast<const char*>(from), size);
  }
  void length(std::size_t n) {
    const std::uint64_t size = n;
    bytes(&size, sizeof size);
  }
  template <Plain T>
  void put(const T& value) {
    bytes(&value, sizeof value);
  }
  void put(const std::string& text) {
    length(text.size());
    bytes(text.data(), text.size());
  }
  void put(const std::filesystem::path& path) { put(path.string()); }
  template <class T>
  void put(const std::vector<T>& all) {
    length(all.size());
    if constexpr (Plain<T>)
      bytes(all.data(), all.size() * sizeof(T));
    else
      for (const T& one : all) put(one);
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    if (value) put(*value);
  }
  template <class A, class B>
  void put(const std::pair<A, B>& both) {
    put(both.first);
    put(both.second);
  }
  template <class K, class V, class L>
  void put(const std::map<K, V, L>& all) {
    length(all.size());
    for (const auto& one : all) put(one);
  }
  template <class... T>
  void put(const std::variant<T...>& value) {
    put(value.index());
    std::visit([this](const auto& one) { this->put(one); }, value);
  }
  template <class T>
  requires std::is_aggregate_v<T>
  void put(const T& value) { members(*this, value); }

  std::string out_;
};

class Reader {
 public:
  explicit Reader(std::string_view bytes) : rest_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  /// Everything was there, and nothing is left.
  bool well() const { return well_ && rest_.empty(); }

 private:
  bool bytes(void* to, std::size_t size) {
    well_ = well_ && size <= rest_.size();
    if (!well_) return false;
    if (size != 0) std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
    return true;
  }
  /// Every element takes a byte at least: a length that is not true costs no memory.
  std::size_t length(std::size_t element = 1) {
    std::uint64_t size = 0;
    if (!bytes(&size, sizeof size)) return 0;
    well_ = well_ && size <= rest_.size() / element;
    return well_ ? size : 0;
  }
  void get(bool& value) {
    unsigned char byte = 0;
    bytes(&byte, 1);
    value = byte != 0;
  }
  template <Plain T>
  void get(T& value) {
    bytes(&value, sizeof value);
  }
  void get(std::string& text) {
    text.resize(length());
    bytes(text.data(), text.size());
  }
  void get(std::filesystem::path& path) {
    std::string text;
    get(text);
    path = text;
  }
  template <class T>
  void get(std::vector<T>& all) {
    if constexpr (Plain<T>) {
      all.resize(length(sizeof(T)));
      bytes(all.data(), all.size() * sizeof(T));
    } else {
      all.clear();
      for (std::size_t n = length(); n > 0 && well_; --n) get(all.emplace_back());
    }
  }
  template <class T>
  void get(std::optional<T>& value) {
    bool there = false;
    get(there);
    value.reset();
    if (there) get(value.emplace(T{}));
  }
  template <class A, class B>
  void get(std::pair<A, B>& both) {
    get(both.first);
    get(both.second);
  }
  template <class K, class V, class L>
  void get(std::map<K, V, L>& all) {
    all.clear();
    for (std::size_t n = length(); n > 0 && well_; --n) {
      std::pair<K, V> one{};
      get(one);
      all.insert(std::move(one));
    }
  }
  template <class... T>
  void get(std::variant<T...>& value) {
    std::size_t index = 0;
    get(index);
    well_ = well_ && index < sizeof...(T);
    if (well_) choose<0>(value, index);
  }
  template <std::size_t i, class... T>
  void choose(std::variant<T...>& value, std::size_t index) {
    if constexpr (i < sizeof...(T)) {
      if (index == i)
        get(value.template emplace<i>());
      else
        choose<i + 1>(value, index);
    }
  }
  template <class T>
  requires std::is_aggregate_v<T>
  void get(T& value) { members(*this, value); }

  std::string_view rest_;
  bool well_ = true;
};

/// All members of a type, in its order: the compiler finds one that is missing here.
#define NONIO_ON_THE_WIRE(Type, ...)                                      \
  template <class Archive, class T>                                       \
  requires std::same_as<std::remove_const_t<T>, Type>                     \
  void members(Archive& archive, T& value) {                              \
    auto& [__VA_ARGS__] = value; /* NOLINT(bugprone-macro-parentheses) */ \
    archive(__VA_ARGS__);                                                 \
  }

NONIO_ON_THE_WIRE(Error, a, b, c, d, e)
NONIO_ON_THE_WIRE(Number, a, b, c)
NONIO_ON_THE_WIRE(Followed, a, b, c, d)
NONIO_ON_THE_WIRE(Value, a, b, c, d, e, f, g)
NONIO_ON_THE_WIRE(Finding, a, b, c, d, e, f)
NONIO_ON_THE_WIRE(Remark, a, b, c, d, e)
NONIO_ON_THE_WIRE(PointTable::Column, a, b, c, d)
NONIO_ON_THE_WIRE(PointTable, a)
NONIO_ON_THE_WIRE(Series, a, b, c, d, e, f, g, h, i)
NONIO_ON_THE_WIRE(Contribution, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(UncertaintyBudget::Result, a, b, c, d, e)
NONIO_ON_THE_WIRE(UncertaintyBudget, a, b, c, d)
NONIO_ON_THE_WIRE(Evaluation, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(Prediction, a, b, c, d, e)
NONIO_ON_THE_WIRE(Artifact, a, b, c)
NONIO_ON_THE_WIRE(OutputResult, a, b, c, d)
NONIO_ON_THE_WIRE(Change, a, b, c, d)
NONIO_ON_THE_WIRE(FileChange, a, b, c)
NONIO_ON_THE_WIRE(Issue::Reason, a, b, c)
NONIO_ON_THE_WIRE(Issue, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
NONIO_ON_THE_WIRE(Conformity, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(ModelFit::Parameter, a, b, c, d, e, f)
NONIO_ON_THE_WIRE(ModelFit::Curve, a, b, c, d, e)
NONIO_ON_THE_WIRE(ModelFit::Effect, a, b, c, d)
NONIO_ON_THE_WIRE(ModelFit::Without, a, b, c, d)
NONIO_ON_THE_WIRE(ModelFit::Candidate, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(ModelFit::Step, a, b, c)
NONIO_ON_THE_WIRE(ModelFit::Channel, a, b, c, d)
NONIO_ON_THE_WIRE(ModelFit::Suspect, a, b)
NONIO_ON_THE_WIRE(ModelFit, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x,
                  y, z, aa, bb, cc, dd)
NONIO_ON_THE_WIRE(Results::Analysed, a, b, c, d, e)
NONIO_ON_THE_WIRE(Results::Written, a, b, c)
NONIO_ON_THE_WIRE(Results, a, b, c, d, e, f)

NONIO_ON_THE_WIRE(Axis, a, b, c, d, e, f, g, h, i, j, k)
NONIO_ON_THE_WIRE(Machine, a, b, c, d, e, f, g, h, i)
NONIO_ON_THE_WIRE(Instrument, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
NONIO_ON_THE_WIRE(Sensor, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(Square, a, b, c)
NONIO_ON_THE_WIRE(Environment, a, b, c, d, e, f, g, h, i, j)
NONIO_ON_THE_WIRE(Cmc, a, b, c)
NONIO_ON_THE_WIRE(Laboratory, a, b, c, d, e, f, g)
NONIO_ON_THE_WIRE(CertificateTexts, a, b, c, d, e, f, g, h, i, j, k, l)
NONIO_ON_THE_WIRE(Tolerance, a, b, c)
NONIO_ON_THE_WIRE(Settings, a)
NONIO_ON_THE_WIRE(Measurement::Channel, a, b, c)
NONIO_ON_THE_WIRE(Measurement, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w,
                  x, y, z, aa, bb)
NONIO_ON_THE_WIRE(Formula::Parameter, a, b, c, d)
NONIO_ON_THE_WIRE(Formula, a, b, c, d, e)
NONIO_ON_THE_WIRE(Campaign, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s)

NONIO_ON_THE_WIRE(HistoryPoint, a, b, c, d, e, f, g, h, i)
NONIO_ON_THE_WIRE(HistorySegment, a, b, c, d, e, f, g, h, i, j)
NONIO_ON_THE_WIRE(HistoryChange, a, b, c, d, e, f, g, h, i, j, k)
NONIO_ON_THE_WIRE(HistoryForecast, a, b, c, d, e, f)
NONIO_ON_THE_WIRE(HistorySeries::Over, a, b)
NONIO_ON_THE_WIRE(HistorySeries, a, b, c, d, e, f, g, h, i, j, k, l)
NONIO_ON_THE_WIRE(MachineEvent, a, b, c, d)
NONIO_ON_THE_WIRE(HistoryStep, a, b, c, d, e, f, g, h, i)
NONIO_ON_THE_WIRE(HistorySoFar, a, b, c, d, e, f, g, h, i, j)

NONIO_ON_THE_WIRE(evaluation::IssuedFile, a, b, c, d)
NONIO_ON_THE_WIRE(evaluation::Certificate, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(evaluation::AssignedNumber, a, b, c)
NONIO_ON_THE_WIRE(evaluation::FollowedQuantity::Common, a, b)
NONIO_ON_THE_WIRE(evaluation::FollowedQuantity, a, b, c, d, e, f, g, h, i, j, k)
NONIO_ON_THE_WIRE(evaluation::ComparedTargets::Fit, a, b, c, d, e, f, g)
NONIO_ON_THE_WIRE(evaluation::ComparedTargets, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(evaluation::FollowedGroup, a, b, c)
NONIO_ON_THE_WIRE(evaluation::ShownHistory, a, b)
NONIO_ON_THE_WIRE(evaluation::AxisCorrection, a, b, c, d)
NONIO_ON_THE_WIRE(evaluation::ControlTables, a, b, c, d, e, f, g, h, i, j, k)
NONIO_ON_THE_WIRE(evaluation::Evaluated, a, b, c, d, e, f, g, h, i, j)

NONIO_ON_THE_WIRE(config::TemplateFiles, a, b)
NONIO_ON_THE_WIRE(config::SiteFiles, a, b)
NONIO_ON_THE_WIRE(config::Event, a, b, c, d, e, f, g)
NONIO_ON_THE_WIRE(config::Acknowledgement, a, b, c, d, e, f, g, h, i, j, k)
NONIO_ON_THE_WIRE(config::Forgotten, a, b, c, d, e)
NONIO_ON_THE_WIRE(config::SiteLogs, a, b, c)
NONIO_ON_THE_WIRE(store::Updated, a, b, c)
NONIO_ON_THE_WIRE(store::MachineAsStated, a, b, c, d)
NONIO_ON_THE_WIRE(store::NamedMachine, a, b, c)
NONIO_ON_THE_WIRE(assessment::HistoryBasis, a, b, c, d, e, f, g, h)
NONIO_ON_THE_WIRE(evaluation::KnownFinding, a, b, c, d, e)
NONIO_ON_THE_WIRE(certificates::Approval, a, b, c, d, e)
NONIO_ON_THE_WIRE(certificates::RegisterEntry, a, b, c, d, e, f, g, h, i, j, k, l, m, n)
NONIO_ON_THE_WIRE(certificates::WaitingDraft, a, b, c, d, e, f, g, h, i)

NONIO_ON_THE_WIRE(Option, a, b, c, d, e, f, g, h, i, j, k)
NONIO_ON_THE_WIRE(Info, a, b, c, d, e)
NONIO_ON_THE_WIRE(loader::PluginFile, a, b, c)
NONIO_ON_THE_WIRE(loader::Catalogue, a, b, c, d, e, f, g, h, i)
#undef NONIO_ON_THE_WIRE

template <class... T>
std::string pack(const T&... values) {
  Writer writer;
  writer(values...);
  return writer.take();
}

/// False if the bytes are not what `pack` makes of such values.
template <class... T>
bool unpack(std::string_view bytes, T&... values) {
  Reader reader(bytes);
  reader(values...);
  return reader.well();
}

}  // namespace nonio::batch::wire

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

/// Values as bytes and back, for what a night keeps for the next one on the same computer. A struct
/// has a function `fields(io, value)` that gives all its members to `io`, for both directions.
namespace nonio::assessment {

class ByteWriter {
 public:
  template <class T>
  requires std::is_trivially_copyable_v<T>
  void put(const T& value) { out_.append(reinterpret_cast<const char*>(&value), sizeof value); }
  void put(const std::string& text) {
    put(static_cast<std::uint64_t>(text.size()));
    out_ += text;
  }
  template <class T>
  void put(const std::optional<T>& value) {
    put(value.has_value());
    put(value.value_or(T{}));
  }
  template <class T, class Put>
  void each(const std::vector<T>& all, Put one) {
    put(static_cast<std::uint64_t>(all.size()));
    for (const T& value : all) one(value);
  }
  std::string take() { return std::move(out_); }
  void put_raw(std::string_view bytes) { out_ += bytes; }
  void reserve(std::size_t bytes) { out_.reserve(bytes); }

  template <class... T>
  void operator()(const T&... values) {
    (one(values), ...);
  }

 private:
  template <class T>
  void one(const T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      put(value);
    else
      fields(*this, value);
  }
  void one(const std::string& text) { put(text); }
  template <class T>
  void one(const std::optional<T>& value) {
    put(value.has_value());
    if (value) one(*value);
  }
  template <class A, class B>
  void one(const std::pair<A, B>& pair) {
    one(pair.first), one(pair.second);
  }
  template <class T>
  void one(const std::vector<T>& all) {
    each(all, [&](const T& value) { one(value); });
  }

  std::string out_;
};

/// Zeros behind the end, and `well` says so.
class ByteReader {
 public:
  explicit ByteReader(std::string_view bytes) : rest_(bytes) {}
  template <class T>
  requires std::is_trivially_copyable_v<T> T get() {
    T value{};
    if (rest_.size() < sizeof value) {
      well_ = false;
      rest_ = {};
      return value;
    }
    std::memcpy(&value, rest_.data(), sizeof value);
    rest_.remove_prefix(sizeof value);
    return value;
  }
  template <class T>
  std::optional<T> perhaps() {
    const bool has = get<char>() != 0;
    const T value = get<T>();
    return has ? std::optional(value) : std::nullopt;
  }
  template <class One>
  void each(One one) {
    const auto n = get<std::uint64_t>();
    for (std::uint64_t i = 0; i < n && well_; ++i) one();
  }
  std::string_view text(std::size_t size) {
    if (rest_.size() < size) {
      well_ = false;
      return {};
    }
    const std::string_view out = rest_.substr(0, size);
    rest_.remove_prefix(size);
    return out;
  }
  bool at_end() const { return rest_.empty(); }
  bool well() const { return well_; }

  template <class... T>
  void operator()(T&... values) {
    (one(values), ...);
  }

 private:
  template <class T>
  void one(T& value) {
    if constexpr (std::is_arithmetic_v<T> || std::is_enum_v<T>)
      value = get<T>();
    else
      fields(*this, value);
  }
  void one(std::string& value) { value = text(get<std::uint64_t>()); }
  template <class T>
  void one(std::optional<T>& value) {
    if (get<char>() == 0) return value.reset();
    one(value.emplace());
  }
  template <class A, class B>
  void one(std::pair<A, B>& pair) {
    one(pair.first), one(pair.second);
  }
  template <class T>
  void one(std::vector<T>& all) {
    all.clear();
    each([&] { one(all.emplace_back()); });
  }

  std::string_view rest_;
  bool well_ = true;
};

}  // namespace nonio::assessment

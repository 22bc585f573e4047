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

/// Binary serialization between processes and runs of one program on one computer; numbers are
/// exact. The bytes may come from a process with plugins, so every length is checked.
namespace nonio::storage {

template <class T>
concept Plain = std::is_arithmetic_v<T> || std::is_enum_v<T>;

class ValueWriter {
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
  void put(std::string_view text) {
    length(text.size());
    bytes(text.data(), text.size());
  }
  void put(const std::string& text) { put(std::string_view(text)); }
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

class ValueReader {
 public:
  explicit ValueReader(std::string_view bytes) : rest_(bytes) {}
  template <class... T>
  void operator()(T&... values) {
    (get(values), ...);
  }
  /// Whether the bytes contained all values and nothing else.
  bool well() const { return well_ && rest_.empty(); }

 private:
  bool bytes(void* to, std::size_t size) {
    well_ = well_ && size <= rest_.size();
    if (!well_) return false;
    if (size != 0) std::memcpy(to, rest_.data(), size);
    rest_.remove_prefix(size);
    return true;
  }
  /// Rejects a length for which the remaining bytes cannot contain enough elements, so that a wrong
  /// length allocates no memory.
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

/// Lists all members of a type in the order of their declaration; a missing one is a compile error.
/// Use it in namespace nonio::storage, where ValueWriter and ValueReader find it.
#define NONIO_MEMBERS(Type, ...)                                          \
  template <class Archive, class T>                                       \
  requires std::same_as<std::remove_const_t<T>, Type>                     \
  void members(Archive& archive, T& value) {                              \
    auto& [__VA_ARGS__] = value; /* NOLINT(bugprone-macro-parentheses) */ \
    archive(__VA_ARGS__);                                                 \
  }

template <class... T>
std::string pack(const T&... values) {
  ValueWriter writer;
  writer(values...);
  return writer.take();
}

/// Returns false if `bytes` is not a result of `pack` for these types.
template <class... T>
bool unpack(std::string_view bytes, T&... values) {
  ValueReader reader(bytes);
  reader(values...);
  return reader.well();
}

}  // namespace nonio::storage

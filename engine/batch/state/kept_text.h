// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <compare>
#include <ostream>
#include <string>
#include <string_view>

namespace nonio::batch {

/// Compact text for values of which a run has very many (ids, folders). It takes its length plus
/// one byte, copies share it, and it stays in memory until the process ends. A std::string takes 32
/// bytes, and at least 32 more from 16 characters on.
class KeptText {
 public:
  KeptText() = default;
  explicit KeptText(std::string_view text);
  KeptText& operator=(std::string_view text) { return *this = KeptText(text); }
  /// Stores equal texts once; this applies to the first few hundred different texts.
  static KeptText shared(std::string_view text);

  std::string_view view() const;
  std::string str() const { return std::string(view()); }
  operator std::string() const { return str(); }
  bool empty() const { return at_ == nullptr; }

  friend bool operator==(const KeptText& a, const KeptText& b) { return a.view() == b.view(); }
  friend bool operator==(const KeptText& a, std::string_view b) { return a.view() == b; }
  friend auto operator<=>(const KeptText& a, const KeptText& b) { return a.view() <=> b.view(); }
  friend auto operator<=>(const KeptText& a, std::string_view b) { return a.view() <=> b; }
  friend std::string operator+(const KeptText& a, std::string_view b) { return a.str().append(b); }
  friend std::ostream& operator<<(std::ostream& out, const KeptText& a) { return out << a.view(); }

 private:
  const char* at_ = nullptr;  ///< address of the text's length, which its bytes follow; null: empty
                              ///< text
};

}  // namespace nonio::batch

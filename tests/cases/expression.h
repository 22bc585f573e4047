// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>

/// Numbers of a case as a person derives them: 18/2.326, 2 + 9/4, sqrt(2*0.09/5), (3 - 1)/2.
class Expression {
 public:
  static std::optional<double> value(std::string_view text) {
    Expression e(text);
    const double v = e.sum();
    e.skip();
    if (e.bad_ || e.at_ != text.size()) return std::nullopt;
    return v;
  }

 private:
  explicit Expression(std::string_view text) : text_(text) {}

  void skip() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
  }
  bool take(char c) {
    skip();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }
  double sum() {
    double v = product();
    while (!bad_) {
      if (take('+'))
        v += product();
      else if (take('-'))
        v -= product();
      else
        break;
    }
    return v;
  }
  double product() {
    double v = factor();
    while (!bad_) {
      if (take('*'))
        v *= factor();
      else if (take('/'))
        v /= factor();
      else
        break;
    }
    return v;
  }
  double bracket() {
    const double v = sum();
    if (!take(')')) bad_ = true;
    return v;
  }
  double factor() {
    if (take('-')) return -factor();
    if (take('(')) return bracket();
    skip();
    constexpr std::string_view root = "sqrt(";
    if (text_.substr(at_, root.size()) == root) {
      at_ += root.size();
      return std::sqrt(bracket());
    }
    double v = 0.0;
    const char* begin = text_.data() + at_;
    const auto [end, error] = std::from_chars(begin, text_.data() + text_.size(), v);
    if (error != std::errc() || !std::isfinite(v)) bad_ = true;
    at_ += static_cast<std::size_t>(end - begin);
    return v;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  bool bad_ = false;
};

// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/other_targets.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "nonio/math/axis_test.h"
#include "nonio/math/followed.h"
#include "nonio/sdk/format.h"

namespace nonio::evaluation {

namespace {

double printed_square(double si, Quantity q) { return printed(printed(si, q), q); }

std::string hexadecimal(std::uint64_t bits) {
  std::string out;
  for (int shift = 60; shift >= 0; shift -= 4) out += "0123456789abcdef"[bits >> shift & 0xF];
  return out;
}

template <class Value>
void put_list(JsonWriter& json, const char* name, std::size_t n, Value value) {
  json.key(name);
  json.begin_array();
  for (std::size_t i = 0; i < n; ++i) json.value(value(i));
  json.end_array();
}

template <class Value>
void put_triangle(JsonWriter& json, const char* name, std::size_t n, Value value) {
  json.key(name);
  json.begin_array();
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = i; j < n; ++j) json.value(value(i * n + j));
  json.end_array();
}

void put_fit(JsonWriter& json, const char* name, const ComparedTargets::Fit& fit, Quantity q) {
  json.key(name);
  json.begin_object();
  json.member("beyond", printed_square(fit.beyond, q));
  json.member("dof", fit.dof);
  if (const std::size_t n = fit.residuals.size(); n > 0)
    put_list(json, "residuals", n, [&](std::size_t i) {
      constexpr double digits = 1e4;  // residuals are rounded to 1e-4 um or arcsec
      return std::round(printed(fit.residuals[i], q) * digits) / digits + 0.0;
    });
  if (const std::size_t n = fit.coefficients.size(); n > 0) {
    put_list(json, "coefficients", n,
             [&](std::size_t i) { return printed(fit.coefficients[i], q); });
    put_triangle(json, "upper", n,
                 [&](std::size_t i) { return printed_square(fit.covariance[i], q); });
    put_triangle(json, "share", n,
                 [&](std::size_t i) { return printed(fit.share[i], Quantity::number); });
  }
  if (const std::size_t n = fit.sinusoids.size() / 3; n > 0) {
    const auto& s = fit.sinusoids;
    put_list(json, "sinusoids", n, [&](std::size_t i) { return printed(s[3 * i], q); });
    put_list(json, "variances", n, [&](std::size_t i) { return printed_square(s[3 * i + 1], q); });
    put_list(json, "shares", n,
             [&](std::size_t i) { return printed(s[3 * i + 2], Quantity::number); });
  }
  json.end_object();
}

}  // namespace

ComparedTargets compared_targets(const nonio::math::AxisTest& test,
                                 const nonio::math::OtherTargets& fits) {
  const auto fit = [](const nonio::math::TargetFit& f) {
    ComparedTargets::Fit out{f.beyond, f.dof, f.coefficients, f.covariance,
                             f.share,  {},    f.residuals};
    for (const auto& s : f.sinusoids)
      out.sinusoids.insert(out.sinusoids.end(), {s.value, s.variance, s.share});
    return out;
  };
  ComparedTargets out{.from = test.targets.front(),
                      .to = test.targets.back(),
                      .rotary = test.rotary,
                      .of_readings = fits.of_readings,
                      .share = fits.share,
                      .mean = fit(fits.mean),
                      .reversal = fit(fits.reversal)};
  const double step = test.rotary ? 0.001 / unit_of(Quantity::angle).per_si : 1e-6;
  out.digest = 0xcbf29ce484222325U;  // initial value of FNV-1a
  for (const double target : test.targets) {
    auto bits = static_cast<std::uint64_t>(std::llround(target / step));
    for (int byte = 0; byte < 8; ++byte, bits >>= 8)
      out.digest = (out.digest ^ (bits & 0xFF)) * 0x100000001b3U;
  }
  return out;
}

void put_other_targets(JsonWriter& json, const ComparedTargets& t,
                       const std::vector<Quantity>& quantities,
                       const std::vector<double>& variances) {
  const Quantity position = t.rotary ? Quantity::angle : Quantity::length,
                 deviation = t.rotary ? Quantity::angular_deviation : Quantity::deviation;
  json.key("other_targets");
  json.begin_object();
  json.member("targets", hexadecimal(t.digest));
  json.member("from", printed(t.from, position));
  json.member("to", printed(t.to, position));
  put_list(json, "other_variance", quantities.size(), [&](std::size_t i) {
    const double readings = i < t.of_readings.size() ? t.of_readings[i] : variances[i];
    return printed_square(std::max(0.0, variances[i] - readings), quantities[i]);
  });
  put_list(json, "share", quantities.size(), [&](std::size_t i) {
    return printed(i < t.share.size() ? t.share[i] : 0.0, Quantity::number);
  });
  put_fit(json, "mean", t.mean, deviation);
  put_fit(json, "reversal", t.reversal, deviation);
  json.end_object();
}

}  // namespace nonio::evaluation

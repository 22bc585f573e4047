// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "campaign/config/measurement_keys.h"
#include "nonio/sdk/method.h"
#include "nonio/sdk/plugin.h"

namespace nonio::loader {

/// Collects the plugins that a file registers; they are accepted all together or not at all.
class Offered final : public Registry {
 public:
  void add(Method method) override {
    if (const std::string why = unfit(method); incomplete_.empty() && !why.empty())
      incomplete_ = "registers the method " + method.info.name + ": " + why;
    take("method", std::move(method));
  }
  void add(Reader reader) override { take("reader", std::move(reader)); }
  void add(Effect effect) override { take("effect", std::move(effect)); }
  void add(Analysis analysis) override { take("analysis", std::move(analysis)); }
  void add(Output output) override { take("output", std::move(output)); }
  void add(Controller c) override { take("controller", std::move(c)); }

  /// Returns the first fault of a plugin; empty if all plugins can be used.
  const std::string& incomplete() const { return incomplete_; }
  void give_to(Registry& registry) {
    for (auto& one : all_) std::visit([&](auto& plugin) { registry.add(std::move(plugin)); }, one);
  }

 private:
  static std::string unfit(const Method& m) {
    for (const Option& key : m.info.options) {
      if (config::common_key(key.name) != nullptr)
        return "the key `" + key.name + "` is one that every method has";
      if (std::holds_alternative<NumberTables>(key.default_value))
        return "the key `" + key.name + "` has tables; expected one table of numbers";
    }
    const auto sound = check(m);
    return sound ? std::string() : sound.error().message;
  }
  static const char* missing(const Method& m) {
    return !m.observe == !m.simulate ? "" : m.observe ? "simulate" : "observe";
  }
  static const char* missing(const Reader& r) {
    return !r.recognises ? "recognises" : !r.reads ? "reads" : !r.read ? "read" : "";
  }
  static const char* missing(const Effect& e) {
    return !e.applies ? "applies" : !e.columns ? "columns" : "";
  }
  static const char* missing(const Analysis& a) {
    if (a.analyse_campaign && !a.applies) return "";
    return !a.applies ? "applies" : !a.analyse ? "analyse" : "";
  }
  static const char* missing(const Output& o) {
    if (o.certificate && !o.certificate->missing_requirements) return "missing_requirements";
    return !o.applies ? "applies" : !o.write ? "write" : "";
  }
  static const char* missing(const Controller& c) {
    return !c.applies ? "applies" : !c.write ? "write" : !c.parse ? "parse" : "";
  }

  template <class Plugin>
  void take(const char* kind, Plugin plugin) {
    const std::string function = missing(plugin);
    if (incomplete_.empty() && !function.empty())
      incomplete_ = std::string("registers the ") + kind + " " + plugin.info.name + " without `" +
                    function + "`, a function that every " + kind + " has";
    all_.emplace_back(std::move(plugin));
  }

  std::vector<std::variant<Method, Reader, Effect, Analysis, Output, Controller>> all_;
  std::string incomplete_;
};

}  // namespace nonio::loader

// SPDX-License-Identifier: Apache-2.0
// Which library writes results.json: the same table of points through nlohmann::ordered_json and
// through Poco::JSON, in one run.
//   g++ -std=c++20 -O2 bench/json_bench.cpp -lPocoJSON -lPocoFoundation -o json_bench &&
//   ./json_bench
#include <Poco/JSON/Array.h>
#include <Poco/JSON/Object.h>

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr int points = 42, repeats = 2000;
const std::vector<std::string> names = {"target", "mean+", "mean-", "mean", "B",  "s+",
                                        "s-",     "R+",    "R-",    "R",    "n+", "n-"};

double value(int i, std::size_t k) { return 1.23456789012 * (i + 1) / static_cast<double>(k + 3); }

std::string with_nlohmann() {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < points; ++i) {
    nlohmann::ordered_json row = nlohmann::ordered_json::object();
    for (std::size_t k = 0; k < names.size(); ++k) row[names[k]] = value(i, k);
    rows.push_back(std::move(row));
  }
  return rows.dump(1);
}

std::string with_poco() {
  Poco::JSON::Array rows;
  for (int i = 0; i < points; ++i) {
    Poco::JSON::Object::Ptr row = new Poco::JSON::Object(Poco::JSON_PRESERVE_KEY_ORDER);
    for (std::size_t k = 0; k < names.size(); ++k) row->set(names[k], value(i, k));
    rows.add(row);
  }
  std::ostringstream out;
  rows.stringify(out, 1);
  return out.str();
}

double microseconds(std::string (*write)(), std::size_t& bytes) {
  const auto began = std::chrono::steady_clock::now();
  for (int i = 0; i < repeats; ++i) bytes = write().size();
  return std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - began)
             .count() /
         repeats;
}

}  // namespace

int main() {
  std::size_t a = 0, b = 0;
  const double nlohmann = microseconds(with_nlohmann, a), poco = microseconds(with_poco, b);
  std::printf("nlohmann::ordered_json %7.1f us, %zu bytes\n", nlohmann, a);
  std::printf("Poco::JSON             %7.1f us, %zu bytes\n", poco, b);
  std::printf("Poco against nlohmann: %.2f times\n", poco / nlohmann);
}

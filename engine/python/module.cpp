// SPDX-License-Identifier: Apache-2.0
// The extension module nonio._nonio; nonio/__init__.py documents it.
#include <dlfcn.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <memory>
#include <tuple>

#include "campaign/evaluation/evaluation.h"
#include "campaign/evaluation/results_json.h"
#include "campaign/modelling/model_json.h"
#include "campaign/modelling/readings_csv.h"
#include "campaign/reading/error_text.h"
#include "nonio/sdk/axis_readings.h"
#include "nonio/sdk/format.h"
#include "platform/storage/json_values.h"

namespace py = pybind11;
namespace fs = std::filesystem;

namespace nonio::python {

namespace {

/// Becomes the Python exception nonio.Error. Unlike a Python exception, it can be thrown while the
/// global interpreter lock of Python is released.
struct Failure {
  Error error;
};

template <class T>
T valued(Expected<T> expected) {
  if (!expected) throw Failure{std::move(expected).error()};
  return *std::move(expected);
}

/// Folder of libnonio_engine; the plugins are in a folder next to it.
fs::path library_folder() {
  Dl_info found{};
  const auto address =
      reinterpret_cast<void*>(static_cast<std::string (*)(const Error&)>(&reading::text_of));
  if (::dladdr(address, &found) == 0 || found.dli_fname == nullptr) return {};
  return fs::weakly_canonical(found.dli_fname).parent_path();
}

Quantity quantity_of(const std::string& unit) {
  for (int i = 0; i <= static_cast<int>(Quantity::angle_per_kelvin); ++i) {
    const auto quantity = static_cast<Quantity>(i);
    if (unit_of(quantity).symbol == unit) return quantity;
  }
  throw Failure{{.message = "unknown unit \"" + unit +
                            "\"; expected one as Nonio prints it: um, "
                            "mm, arcsec, deg, um/m, K, s, \"\""}};
}

using Columns = std::map<std::string, std::vector<double>>;

Columns readings_columns(const Observations& o, const AxisReadings& r, const Axis& axis) {
  Columns out;
  const auto put = [&](const char* name, const std::vector<double>& values, Quantity quantity) {
    std::vector<double>& column = out[name];
    for (const double v : values) column.push_back(printed(v, quantity));
  };
  put("target", r.theta, position_of(axis.rotary));
  put("direction", r.d, Quantity::number);
  put("time_s", r.t, Quantity::time);
  put("material_c", o.material, Quantity::temperature);
  std::vector<double>& run = out["run"];
  for (std::size_t i = 0; i < o.size(); ++i) run.push_back(static_cast<double>(o.run_of(i)));
  return out;
}

struct OwnEffect {
  std::string name;
  std::vector<std::pair<std::string, std::string>> parameters;
  std::vector<std::tuple<std::string, std::string, std::vector<double>>> shapes;
  py::function columns;
};

Expected<Effect::Columns> called(const std::shared_ptr<const OwnEffect>& own, const Observations& o,
                                 const Axis& axis, const std::vector<Quantity>& parameters,
                                 const std::vector<Quantity>& shapes,
                                 const std::vector<double>& shape) {
  NONIO_TRY(const auto readings, readings_of(o, axis));
  const py::gil_scoped_acquire lock;
  try {
    py::list arguments;
    arguments.append(readings_columns(o, readings, axis));
    for (std::size_t k = 0; k < shape.size(); ++k)
      arguments.append(shape[k] * unit_of(shapes[k]).per_si);
    auto columns = own->columns(*py::tuple(arguments)).cast<Effect::Columns>();
    if (columns.size() != parameters.size())
      return fail("effect " + own->name + ": expected " + std::to_string(parameters.size()) +
                  " columns, one for each parameter, found " + std::to_string(columns.size()));
    const double deviation = unit_of(deviation_of(o.angular)).per_si;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (columns[k].size() != o.size())
        return fail("effect " + own->name + ": expected " + std::to_string(o.size()) +
                    " values in a column, one for each reading, found " +
                    std::to_string(columns[k].size()));
      for (std::size_t i = 0; i < columns[k].size(); ++i)
        columns[k][i] *= readings.moved[i] != 0 ? unit_of(parameters[k]).per_si / deviation : 0.0;
    }
    return columns;
  } catch (const py::error_already_set& e) {
    return fail("effect " + own->name + ": " +
                py::str(e.type().attr("__name__")).cast<std::string>() + ": " +
                py::str(e.value()).cast<std::string>());
  } catch (const py::cast_error&) {
    return fail("effect " + own->name + ": expected a list of columns, each of numbers");
  }
}

Effect effect_of(OwnEffect given) {
  auto own = std::make_shared<const OwnEffect>(std::move(given));
  Effect effect;
  effect.info = {own->name, "1", "An effect of a program"};
  std::vector<Quantity> parameters, shapes;
  for (const auto& [name, unit] : own->parameters) {
    parameters.push_back(quantity_of(unit));
    effect.linear.push_back({name, "", parameters.back(), parameters.back()});
  }
  for (const auto& [name, unit, values] : own->shapes) {
    const Quantity quantity = quantity_of(unit);
    shapes.push_back(quantity);
    std::vector<double> grid;
    for (const double v : values) grid.push_back(v / unit_of(quantity).per_si);
    effect.shapes.push_back({.parameter = {name, "", quantity, quantity},
                             .grid = [grid](const Observations&, const Axis&) { return grid; }});
  }
  effect.applies = [](const Observations& o, const Axis& axis) {
    return readings_of(o, axis).has_value();
  };
  effect.columns = [own, parameters, shapes](const Observations& o, const Axis& axis,
                                             const std::vector<double>& shape) {
    return called(own, o, axis, parameters, shapes, shape);
  };
  return effect;
}

/// The constructor and the methods evaluate, compare and explain release the global interpreter
/// lock.
class OpenedCampaign {
 public:
  OpenedCampaign(const fs::path& folder, std::vector<fs::path> plugins,
                 std::vector<fs::path> templates) {
    const fs::path library = library_folder();
    plugins.push_back(library / "plugins");
    templates.insert(templates.begin(),
                     (library / NONIO_TEMPLATES_FROM_LIBRARY).lexically_normal());
    const py::gil_scoped_release free;
    place_ = valued(reading::open_workplace(folder, plugins, templates, NONIO_VERSION));
    read_ = reading::read_campaign(folder, place_->context, stage);
    if (!read_.manifest) throw Failure{read_.errors.front()};
  }

  const Campaign& campaign() const { return read_.manifest->campaign; }
  const std::vector<std::string>& model() const { return campaign().model; }
  const std::vector<Error>& errors() const { return read_.errors; }
  const std::vector<std::string>& notes() const { return place_->notes; }

  std::vector<std::tuple<std::string, std::string, std::string, std::string, std::size_t>>
  measurements() const {
    std::vector<std::tuple<std::string, std::string, std::string, std::string, std::size_t>> out;
    for (std::size_t k = 0; k < campaign().measurements.size(); ++k) {
      const Measurement& m = campaign().measurements[k];
      out.emplace_back(m.id, method_name(m), m.axis, m.file,
                       k < read_.observations.size() ? read_.observations[k].size() : 0);
    }
    return out;
  }

  /// Columns are named with their units and ordered as in a file of readings; NaN for a missing
  /// value.
  std::vector<std::pair<std::string, std::vector<double>>> readings(const std::string& id) const {
    const auto found = std::find_if(campaign().measurements.begin(), campaign().measurements.end(),
                                    [&](const Measurement& m) { return m.id == id; });
    if (found == campaign().measurements.end())
      throw Failure{{.message = "there is no measurement \"" + id + "\""}};
    const Observations& o =
        read_.observations.at(static_cast<std::size_t>(found - campaign().measurements.begin()));
    std::vector<std::pair<std::string, std::vector<double>>> out;
    const auto put = [&](const std::string& name, const auto& values, Quantity quantity) {
      if (values.empty()) return;
      auto& column =
          out.emplace_back(name + std::string(unit_of(quantity).suffix), std::vector<double>())
              .second;
      for (const auto v : values) column.push_back(printed(static_cast<double>(v), quantity));
    };
    put("line", o.line, Quantity::number);
    put("run", o.run, Quantity::number);
    for (const auto& axis : o.axes) {
      put(axis.axis, axis.position, position_of(axis.rotary));
      put(axis.axis + "_dir", axis.approach, Quantity::number);
    }
    put("deviation", o.deviation, deviation_of(o.angular));
    put("time", o.time, Quantity::time);
    put("material", o.material, Quantity::temperature);
    put("air", o.air, Quantity::temperature);
    put("pressure_hpa", o.pressure, Quantity::number);
    put("humidity_pct", o.humidity, Quantity::number);
    put("file_line", o.source_line, Quantity::number);
    return out;
  }

  std::string evaluate() const {
    const py::gil_scoped_release free;
    auto analysed = evaluation::analyse(read_, campaign().id, place_->context, stage, {});
    analysed.documents.clear();
    return evaluation::results_json(
        evaluation::write_documents(std::move(analysed), nullptr, place_->context, stage),
        place_->context);
  }

  /// Returns JSON (nonio-compare/1), and CSV with one row per reading.
  std::pair<std::string, std::string> compare(const std::vector<std::string>& model,
                                              const std::vector<OwnEffect>& effects) const {
    const reading::ReadCampaign read = with(effects);
    const py::gil_scoped_release free;
    std::vector<modelling::Compared> all;
    for (modelling::PartModel& part : parts(read, model)) {
      auto comparison = valued(modelling::compare_part(part));
      all.push_back({std::move(part), std::move(comparison)});
    }
    const modelling::ModelWords words(place_->context.templates, "en");
    return {storage::dump(modelling::compare_json(all, campaign(), words, {}, read.errors)),
            modelling::readings_csv(all)};
  }

  std::string explain(const std::vector<std::string>& model, const std::vector<OwnEffect>& effects,
                      std::uint64_t seed, bool library) const {
    const reading::ReadCampaign read = with(effects);
    const py::gil_scoped_release free;
    std::vector<modelling::Explained> all;
    for (modelling::PartModel& part : parts(read, model)) {
      auto explanation = valued(modelling::explain_part(part, seed, nullptr, library));
      all.push_back({std::move(part), std::move(explanation)});
    }
    const modelling::ModelWords words(place_->context.templates, "en");
    return storage::dump(
        modelling::explain_json(all, campaign(), words, seed, {}, {}, read.errors));
  }

 private:
  static void stage(const std::string&) {}

  reading::ReadCampaign with(const std::vector<OwnEffect>& effects) const {
    reading::ReadCampaign read = read_;
    for (const OwnEffect& own : effects) {
      if (std::any_of(read.effects.begin(), read.effects.end(),
                      [&](const Effect& e) { return e.info.name == own.name; }))
        throw Failure{
            {.message = "there is an effect \"" + own.name + "\" already; expected another name"}};
      read.effects.push_back(effect_of(own));
    }
    return read;
  }

  static std::vector<modelling::PartModel> parts(const reading::ReadCampaign& read,
                                                 const std::vector<std::string>& model) {
    auto found = valued(modelling::part_models(read, model));
    if (found.empty()) throw Failure{modelling::nothing_to_compare(read)};
    return found;
  }

  std::unique_ptr<reading::Workplace> place_;
  reading::ReadCampaign read_;
};

py::tuple error_arguments(const Error& e) {
  return py::make_tuple(reading::text_of(e), e.message, e.file, e.line, e.column);
}

}  // namespace

}  // namespace nonio::python

PYBIND11_MODULE(_nonio, module) {
  using namespace nonio::python;
  module.attr("version") = NONIO_VERSION;
  // The Python class nonio.Error. It must outlive the module, because an exception may still be
  // active when the module ends.
  static py::object raised;
  module.def("raise_with", [](const py::object& type) { raised = type; });
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const Failure& f) {
      const py::object made = raised(*error_arguments(f.error));
      PyErr_SetObject(raised.ptr(), made.ptr());
    }
  });
  py::class_<OwnEffect>(module, "Effect")
      .def(py::init([](std::string name, std::vector<std::pair<std::string, std::string>> p,
                       std::vector<std::tuple<std::string, std::string, std::vector<double>>> s,
                       py::function columns) {
        return OwnEffect{std::move(name), std::move(p), std::move(s), std::move(columns)};
      }))
      .def_readonly("name", &OwnEffect::name);
  py::class_<OpenedCampaign>(module, "Campaign")
      .def(py::init<const std::filesystem::path&, std::vector<std::filesystem::path>,
                    std::vector<std::filesystem::path>>())
      .def_property_readonly("id", [](const OpenedCampaign& c) { return c.campaign().id; })
      .def_property_readonly("model", &OpenedCampaign::model)
      .def_property_readonly("notes", &OpenedCampaign::notes)
      .def_property_readonly("errors",
                             [](const OpenedCampaign& c) {
                               py::list all;
                               for (const nonio::Error& e : c.errors())
                                 all.append(raised(*error_arguments(e)));
                               return all;
                             })
      .def_property_readonly("measurements", &OpenedCampaign::measurements)
      .def("readings", &OpenedCampaign::readings)
      .def("evaluate", &OpenedCampaign::evaluate)
      .def("compare", &OpenedCampaign::compare)
      .def("explain", &OpenedCampaign::explain);
}

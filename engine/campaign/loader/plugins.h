// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/error.h"
#include "nonio/sdk/plugin.h"

namespace nonio::loader {

struct PluginFile {
  std::filesystem::path path;
  std::string refused;               ///< reason of the refusal; empty if the file was loaded
  std::vector<std::string> brought;  ///< registered plugins, such as "analysis iso230-2 1.0.0"
};

/// Declarations of all plugins, for a process without their code.
struct Catalogue {
  std::vector<PluginFile> files;
  std::vector<std::string> conflicts;
  std::vector<std::pair<std::string, std::filesystem::path>> names;
  std::vector<Info> methods, readers, effects, analyses, outputs, controllers;
};

/// The plugins stay loaded until the process ends.
class Plugins final : public Registry {
 public:
  Plugins() = default;
  /// Contains only declarations; none of the plugins can be called.
  explicit Plugins(Catalogue catalogue);
  Catalogue catalogue() const;

  /// Returns shared libraries by folder, sorted by name. An unreadable folder is a conflict.
  std::vector<std::filesystem::path> files_in(const std::vector<std::filesystem::path>& folders);
  /// Loads a file, or records a nonempty `refusal`. A plugin may crash the calling process.
  void load_file(const std::filesystem::path& path, const std::string& refusal);

  /// Loads every shared library of the folders. Libraries that `process::must_be_tried` selects are
  /// tried in a child process first. The ABI tag is compared before any function is called.
  void load(const std::vector<std::filesystem::path>& folders);

  const std::vector<PluginFile>& files() const { return files_; }
  /// Messages about plugins with equal names (outputs and controllers share names), unreadable
  /// folders, and files for which memory was insufficient.
  const std::vector<std::string>& conflicts() const { return conflicts_; }
  bool all_from(const std::filesystem::path& folder) const;
  Expected<std::string> digest() const;

  const std::vector<Method>& methods() const { return methods_; }
  const Method* method(std::string_view kind) const;
  const std::vector<Reader>& readers() const { return readers_; }
  const std::vector<Effect>& effects() const { return effects_; }
  const std::vector<Analysis>& analyses() const { return analyses_; }
  const std::vector<Output>& outputs() const { return outputs_; }
  const Output* output_of(Output::Role role) const {
    for (const Output& o : outputs_)
      if (o.role == role) return &o;
    return nullptr;
  }
  const std::vector<Controller>& controllers() const { return controllers_; }

  /// Plugins of different kinds with the same name share the table [options.<name>].
  std::vector<Option> options_of_namesakes(const Info& plugin) const;

  /// Returns why a plugin is missing, with the nearest name. For outputs, controllers are included,
  /// because `[run] outputs` names both.
  std::string absence(std::string_view kind, std::string_view name) const;
  std::string refusals() const;
  /// Returns one note per reason, because an update may refuse all plugins for one reason.
  std::vector<std::string> refusal_notes() const;

  void add(Method) override;
  void add(Reader) override;
  void add(Effect) override;
  void add(Analysis) override;
  void add(Output) override;
  void add(Controller) override;

 private:
  bool accept(std::string_view kind, const Info& info);

  std::vector<PluginFile> files_;
  std::vector<std::string> conflicts_;
  std::vector<std::pair<std::string, std::filesystem::path>> names_;
  std::vector<Method> methods_;
  std::vector<Reader> readers_;
  std::vector<Effect> effects_;
  std::vector<Analysis> analyses_;
  std::vector<Output> outputs_;
  std::vector<Controller> controllers_;
};

/// Returns an error unless the library is a plugin for this program. The library is never unloaded.
Expected<const PluginEntry*> open_entry(const std::filesystem::path& path);

/// Omits weak symbols, because compilers add copies of templates of the standard library.
Expected<std::vector<std::string>> exported_symbols(const std::filesystem::path& library);

}  // namespace nonio::loader

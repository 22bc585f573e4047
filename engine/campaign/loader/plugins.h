// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::loader {

/// A file in a plugin folder: the plugins that it registered, or why it was refused.
struct PluginFile {
  std::filesystem::path path;
  std::string refused;               ///< why the file was refused; empty: it was loaded
  std::vector<std::string> brought;  ///< plugins that it registered: "analysis iso230-2 1.0.0", ...
};

/// The declarations of all plugins as data, for a process that has none of their code.
struct Catalogue {
  std::vector<PluginFile> files;
  std::vector<std::string> conflicts;
  std::vector<std::pair<std::string, std::filesystem::path>> names;
  std::vector<Info> methods, readers, effects, analyses, outputs, controllers;
};

/// All plugins of this process. Loaded once, never unloaded.
class Plugins final : public Registry {
 public:
  Plugins() = default;
  /// Makes an object with the declarations only; none of the plugins can be called.
  explicit Plugins(Catalogue catalogue);
  Catalogue catalogue() const;

  /// Returns the shared libraries in the folders, in the order of the folders and sorted in each. A
  /// folder that cannot be read is recorded as a conflict.
  std::vector<std::filesystem::path> files_in(const std::vector<std::filesystem::path>& folders);
  /// Loads and registers a file, or only records `refusal` if it is not empty. A plugin may crash
  /// the process, so this function is only called in a process whose end is detected.
  void load_file(const std::filesystem::path& path, const std::string& refusal);

  /// Loads every shared library of the folders, in their order. A library that
  /// `process::must_be_tried` selects is first tried in a child process and refused if it crashes
  /// or hangs there. The ABI tag is compared before any function of a library is called.
  void load(const std::vector<std::filesystem::path>& folders);

  const std::vector<PluginFile>& files() const { return files_; }
  /// Messages about two plugins of one kind with the same name, with both paths (outputs and
  /// controllers are regarded as one kind), about folders that cannot be read, and about files for
  /// which there was not enough memory.
  const std::vector<std::string>& conflicts() const { return conflicts_; }
  /// Whether all loaded plugins are in this folder.
  bool all_from(const std::filesystem::path& folder) const;
  /// Reads all files of loaded plugins and returns one digest of them.
  Expected<std::string> digest() const;

  const std::vector<Method>& methods() const { return methods_; }
  /// Returns the method for this kind of measurement; null if none is loaded.
  const Method* method(std::string_view kind) const;
  const std::vector<Reader>& readers() const { return readers_; }
  const std::vector<Effect>& effects() const { return effects_; }
  const std::vector<Analysis>& analyses() const { return analyses_; }
  const std::vector<Output>& outputs() const { return outputs_; }
  /// Returns the first output with this role; null if there is none.
  const Output* output_of(Output::Role role) const {
    for (const Output& o : outputs_)
      if (o.role == role) return &o;
    return nullptr;
  }
  const std::vector<Controller>& controllers() const { return controllers_; }

  /// Returns the options of plugins of other kinds with the same name, because they share the table
  /// [options.<name>].
  std::vector<Option> options_of_namesakes(const Info& plugin) const;

  /// Returns a message why a plugin of this name is missing, with the nearest name. For an output,
  /// names of controllers are included, because `[run] outputs` may name them too.
  std::string absence(std::string_view kind, std::string_view name) const;
  /// Returns every refused file with its reason; empty if none was refused.
  std::string refusals() const;
  /// Returns a note per reason of refusal, because after an update all plugins may be refused for
  /// one reason.
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
  // Kind and name of each plugin, "analysis iso230-2", and its file
  std::vector<std::pair<std::string, std::filesystem::path>> names_;
  std::vector<Method> methods_;
  std::vector<Reader> readers_;
  std::vector<Effect> effects_;
  std::vector<Analysis> analyses_;
  std::vector<Output> outputs_;
  std::vector<Controller> controllers_;
};

}  // namespace nonio::loader

// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "nonio/sdk/plugin.h"

namespace nonio::loader {

/// One file in a plugin folder: what it brought, or why it was refused.
struct PluginFile {
  std::filesystem::path path;
  std::string refused;               ///< empty: loaded
  std::vector<std::string> brought;  ///< "analysis iso230-2 1.0.0", ...
};

/// The declarations of plugins, as data: how a process knows them that has none of their code.
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
  /// Their descriptions; nothing of them can be called.
  explicit Plugins(Catalogue catalogue);
  Catalogue catalogue() const;

  /// The shared libraries of the folders, in their order; a folder that cannot be read is a
  /// conflict.
  std::vector<std::filesystem::path> files_in(const std::vector<std::filesystem::path>& folders);
  /// Loads and registers one; if `refusal` is not empty, only that is recorded. To be called in a
  /// process that may come to harm.
  void load_file(const std::filesystem::path& path, const std::string& refusal);

  /// Loads every shared library of the folders, in their order. They are first loaded and
  /// registered in a child process, so that one which crashes or hangs there is refused instead of
  /// loaded; the ABI tag is compared before anything in it is called.
  void load(const std::vector<std::filesystem::path>& folders);

  const std::vector<PluginFile>& files() const { return files_; }
  /// Two plugins of one kind with the same name, each with both paths; outputs and controllers are
  /// one kind in this.
  const std::vector<std::string>& conflicts() const { return conflicts_; }
  /// Whether every plugin that was loaded is in this folder.
  bool all_from(const std::filesystem::path& folder) const;
  /// One digest over the files of all that was loaded; reads them.
  Expected<std::string> digest() const;

  const std::vector<Method>& methods() const { return methods_; }
  /// The method of this kind of measurement; null if none is loaded.
  const Method* method(std::string_view kind) const;
  const std::vector<Reader>& readers() const { return readers_; }
  const std::vector<Effect>& effects() const { return effects_; }
  const std::vector<Analysis>& analyses() const { return analyses_; }
  const std::vector<Output>& outputs() const { return outputs_; }
  /// The first output with this role; null if there is none.
  const Output* output_of(Output::Role role) const {
    for (const Output& o : outputs_)
      if (o.role == role) return &o;
    return nullptr;
  }
  const std::vector<Controller>& controllers() const { return controllers_; }

  /// Options of plugins of other kinds with the same name: [options.<name>] is a table of all.
  std::vector<Option> options_of_namesakes(const Info& plugin) const;

  /// Why a plugin of that name is missing, with the nearest name; of an output also among the
  /// controllers, which `[run] outputs` names with them.
  std::string absence(std::string_view kind, std::string_view name) const;
  /// Every file that was refused, with the reason; empty if none was.
  std::string refusals() const;
  /// A note for each reason: after an update that may be all plugins for one.
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
  std::vector<std::pair<std::string, std::filesystem::path>> names_;  // "analysis iso230-2"
  std::vector<Method> methods_;
  std::vector<Reader> readers_;
  std::vector<Effect> effects_;
  std::vector<Analysis> analyses_;
  std::vector<Output> outputs_;
  std::vector<Controller> controllers_;
};

}  // namespace nonio::loader

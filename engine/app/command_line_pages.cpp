// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <ostream>

#include "command_line.h"
#include "platform/storage/json_values.h"

namespace nonio::app {

namespace {

/// `visit` receives the path of the command, such as "nonio plan triples", and the command.
template <class Visit>
void each(const std::vector<Verb>& verbs, const std::string& path, const Visit& visit) {
  for (const Verb& v : verbs) {
    visit(path + " " + v.name, v);
    each(v.verbs, path + " " + v.name, visit);
  }
}

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

std::string replaced(std::string text, char what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
    text.replace(at, 1, by);
  return text;
}

std::string roff(const std::string& text) {
  std::string out = replaced(replaced(text, '\\', "\\e"), '-', "\\-");
  std::string lines;
  bool begins = true;
  for (const char c : out) {
    if (begins && (c == '.' || c == '\'')) lines += "\\&";
    lines += c;
    begins = c == '\n';
  }
  return lines;
}

std::string in_capitals(std::string text) {
  for (char& c : text)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 32);
  return text;
}

void write_roff_examples(std::ostream& out, const std::vector<std::string>& examples) {
  if (examples.empty()) return;
  out << ".PP\n.nf\n";
  for (const std::string& example : examples) out << roff(example) << "\n";
  out << ".fi\n";
}

void write_roff_paragraphs(std::ostream& out, const std::string& text) {
  if (!text.empty()) out << ".PP\n" << roff(replaced(text, '\n', "\n.br\n")) << "\n";
}

std::string in_single_quotes(const std::string& text) {
  return "'" + replaced(text, '\'', "'\\''") + "'";
}

std::string joined_names(const std::vector<Verb>& verbs, const char* between) {
  std::string out;
  for (const Verb& v : verbs) out += (out.empty() ? "" : between) + v.name;
  return out;
}

std::string in_words(const std::vector<std::string>& words) {
  std::string out;
  for (const std::string& word : words) out += (out.empty() ? "" : " ") + word;
  return out;
}

std::string bash_values(const Argument& a) {
  const auto& words = a.choices.empty() ? a.offers : a.choices;
  if (!words.empty()) return "-W " + in_single_quotes(in_words(words));
  switch (a.takes) {
    case Argument::Takes::folder:
      return "-d";
    case Argument::Takes::file:
    case Argument::Takes::path:
      return "-f";
    case Argument::Takes::control:
      return "-W '$(nonio table controls 2> /dev/null | sed '1d;s/ .*//')'";
    case Argument::Takes::number:
    case Argument::Takes::day:
    case Argument::Takes::anything:
      break;
  }
  return "-W ''";
}

void write_bash(const Program& program, std::ostream& out) {
  const std::string& name = program.name;
  out << "# bash completion for " << name << "; made by `" << name << " completion bash`\n_" << name
      << "() {\n"
         "  local cur=${COMP_WORDS[COMP_CWORD]} prev=${COMP_WORDS[COMP_CWORD - 1]} path="
      << name
      << " i\n"
         "  for ((i = 1; i < COMP_CWORD; i++)); do\n"
         "    case \"$path ${COMP_WORDS[i]}\" in\n";
  each(program.verbs, name,
       [&](const std::string& path, const Verb&) { out << "      \"" << path << "\") ;;\n"; });
  out << "      *) continue ;;\n    esac\n    path=\"$path ${COMP_WORDS[i]}\"\n  done\n"
         "  local offer=\"-W ''\" equals=\n"
         "  [[ $cur == '=' ]] && cur= equals='='\n"
         "  [[ $prev == '=' ]] && prev=${COMP_WORDS[COMP_CWORD - 2]} equals='='\n"
         "  case \"$path $prev$equals\" in\n";
  each(program.verbs, name, [&](const std::string& path, const Verb& v) {
    for (const Argument& a : v.arguments) {
      if (a.is_positional() || a.is_flag() || a.hidden) continue;
      const std::string option = path + " " + a.name;
      out << "    ";
      if (a.needs_value()) out << "\"" << option << "\" | ";
      out << "\"" << option << "=\") offer=\"" << bash_values(a) << "\" ;;\n";
    }
  });
  out << "    *)\n      case \"$path\" in\n";
  const auto write_words = [&](const std::string& path, const Verb& v) {
    std::vector<std::string> words, values;
    for (const Verb& inner : v.verbs) words.push_back(inner.name);
    for (const Argument& a : v.arguments)
      if (a.is_positional())
        values.push_back(bash_values(a));
      else if (!a.hidden)
        words.push_back(a.name);
    words.emplace_back("--help");
    out << "        \"" << path << "\") offer=\"-W '" << in_words(words) << "'\"";
    if (!values.empty()) out << "; [[ $cur == -* ]] || offer=\"" << values.front() << "\"";
    out << " ;;\n";
  };
  write_words(name, {.name = name, .summary = {}, .verbs = program.verbs});
  each(program.verbs, name, write_words);
  out << "      esac ;;\n  esac\n"
         "  case \"$offer\" in\n"
         "    -d | -f) compopt -o filenames 2> /dev/null;  mapfile -t COMPREPLY < <(compgen $offer "
         "-- \"$cur\") ;;\n"
         "    *) mapfile -t COMPREPLY < <(eval \"compgen $offer\" -- '\"$cur\"') ;;\n"
         "  esac\n}\ncomplete -F _"
      << name << " " << name << "\n";
}

std::string zsh_text(const std::string& text) {
  std::string out = replaced(one_line(text), '\\', "\\\\");
  for (const char c : {'[', ']', ':'}) out = replaced(out, c, std::string("\\") + c);
  return replaced(out, '\'', "'\\''");
}

std::string zsh_values(const Argument& a) {
  const auto& words = a.choices.empty() ? a.offers : a.choices;
  if (!words.empty()) return "(" + in_words(words) + ")";
  switch (a.takes) {
    case Argument::Takes::folder:
      return "_files -/";
    case Argument::Takes::file:
    case Argument::Takes::path:
      return "_files";
    case Argument::Takes::control:
    case Argument::Takes::number:
    case Argument::Takes::day:
    case Argument::Takes::anything:
      break;
  }
  return " ";
}

void write_zsh_arguments(const Verb& v, const std::string& indent, std::ostream& out) {
  out << indent << "_arguments -s '--help[help of this verb]'";
  for (const Argument& a : v.arguments) {
    if (a.hidden) continue;
    const bool many = a.is_list();
    out << " \\\n" << indent << "  '";
    if (a.is_positional()) {
      out << (many ? "*" : "") << ":" << zsh_text(a.name) << ":" << zsh_values(a) << "'";
      continue;
    }
    out << (many ? "*" : "") << a.name
        << (a.is_flag()       ? ""
            : a.needs_value() ? "="
                              : "=-")
        << "[" << zsh_text(a.help) << "]";
    if (!a.is_flag()) out << (a.needs_value() ? ":" : "::") << "value:" << zsh_values(a);
    out << "'";
  }
  out << "\n";
}

void write_zsh_verbs(const std::vector<Verb>& verbs, const std::string& indent, std::ostream& out) {
  out << indent << "local -a verbs=(\n";
  for (const Verb& v : verbs)
    out << indent << "  '" << zsh_text(v.name) << ":" << zsh_text(v.summary) << "'\n";
  out << indent << ")\n" << indent << "_describe verb verbs\n";
}

void write_zsh_function(const std::string& function, const std::vector<Verb>& verbs,
                        std::ostream& out) {
  for (const Verb& v : verbs)
    if (!v.verbs.empty()) write_zsh_function(function + "_" + v.name, v.verbs, out);
  out << function << "() {\n  if (( CURRENT == 2 )); then\n";
  write_zsh_verbs(verbs, "    ", out);
  out << "    return\n  fi\n  local verb=$words[2]\n  shift words\n  (( CURRENT-- ))\n  case $verb "
         "in\n";
  for (const Verb& v : verbs) {
    out << "    " << v.name << ")\n";
    if (v.run && !v.verbs.empty())
      out << "      if [[ -z $words[2] || \" " << joined_names(v.verbs, " ")
          << " \" != *\" $words[2] \"* ]]; then\n";
    if (v.run) write_zsh_arguments(v, "      ", out);
    if (v.run && !v.verbs.empty()) out << "      return; fi\n";
    if (!v.verbs.empty()) out << "      " << function << "_" << v.name << "\n";
    out << "      ;;\n";
  }
  out << "  esac\n}\n";
}

}  // namespace

void write_man_page(const Program& program, std::ostream& out) {
  out << ".\\\" SPDX-License-Identifier: Apache-2.0\n.TH " << in_capitals(program.name)
      << " 1 \"\" \"" << program.name << " " << program.version
      << "\" \"User commands\"\n.SH NAME\n"
      << program.name << " \\- " << roff(program.purpose) << "\n.SH SYNOPSIS\n";
  for (const Verb& v : program.verbs)
    out << ".B " << roff(synopsis(program.name + " " + v.name, v)) << "\n.br\n";
  out << ".SH DESCRIPTION\n" << roff(one_line(program.summary)) << "\n";
  std::string heading;
  const auto at_top = [](const std::string& path) {
    return std::count(path.begin(), path.end(), ' ') == 1;
  };
  each(program.verbs, program.name, [&](const std::string& path, const Verb& v) {
    if (!v.heading.empty() && v.heading != heading && at_top(path))
      out << ".SH " << in_capitals(heading = v.heading) << "\n";
    out << ".SS " << roff(synopsis(path, v)) << "\n"
        << roff(v.summary) << (v.summary.ends_with('?') ? "" : ".") << "\n";
    for (const Argument& a : v.arguments) {
      if (a.hidden) continue;
      out << ".TP\n.B " << roff(a.name) << "\n" << roff(one_line(a.help));
      if (!a.choices.empty()) out << "; one of " << roff(in_words(a.choices));
      out << "\n";
    }
    write_roff_paragraphs(out, v.footer);
    write_roff_examples(out, v.examples);
  });
  out << ".SH EXIT STATUS\n" << roff(one_line(program.footer)) << "\n";
}

void write_completion(const Program& program, const std::string& shell, std::ostream& out) {
  if (shell == "bash") return write_bash(program, out);
  out << "#compdef " << program.name << "\n# zsh completion; made by `" << program.name
      << " completion zsh`\n";
  write_zsh_function("_" + program.name, program.verbs, out);
  out << "_" << program.name << " \"$@\"\n";
}

namespace {

using storage::Json;

const char* kind_of(const Argument& a) {
  constexpr const char* kinds[] = {"flag", "text", "list", "integer", "integer", "number"};
  return kinds[a.target.index()];
}

Json to_json(const Argument& a) {
  Json json = {
      {"name", a.name}, {"kind", kind_of(a)}, {"required", a.required}, {"help", one_line(a.help)}};
  if (!a.choices.empty()) json["choices"] = a.choices;
  if (a.range) json["range"] = {a.range->first, a.range->second};
  if (!a.bare.empty()) json["value_of_bare"] = a.bare;
  if (!a.old.empty()) json["old"] = a.old;
  if (a.hidden) json["hidden"] = true;
  return json;
}

}  // namespace

void write_table(const Program& program, std::ostream& out) {
  Json commands = Json::array(), aliases = Json::array(), synonyms = Json::object();
  each(program.verbs, program.name, [&](const std::string& path, const Verb& v) {
    Json arguments = Json::array();
    for (const Argument& a : v.arguments) arguments.push_back(to_json(a));
    commands.push_back({{"command", path},
                        {"listed", !v.heading.empty()},
                        {"runs", bool(v.run)},
                        {"summary", v.summary},
                        {"arguments", std::move(arguments)},
                        {"text", v.footer},
                        {"examples", v.examples}});
  });
  for (const Alias& alias : program.aliases)
    aliases.push_back({{"old", program.name + " " + alias.old_words},
                       {"command", program.name + " " + alias.words},
                       {"announced", alias.is_announced}});
  for (const auto& [word, command] : program.synonyms)
    synonyms[word] = program.name + " " + command;
  out << Json{{"schema", "nonio-commands/1"},
              {"commands", std::move(commands)},
              {"aliases", std::move(aliases)},
              {"synonyms", std::move(synonyms)}}
             .dump(1)
      << "\n";
}

}  // namespace nonio::app

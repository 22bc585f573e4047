// SPDX-License-Identifier: Apache-2.0
#include "campaign/evaluation/issue_json.h"

namespace nonio::evaluation {

namespace {

void put_if_there(JsonWriter& json, const char* key, const std::string& text) {
  if (!text.empty()) json.member(key, text);
}

void put_change(JsonWriter& json, const Change& change) {
  json.begin_object();
  put_if_there(json, "key", change.key);
  if (change.line != 0) json.member("line", change.line);
  if (change.before) json.member("before", *change.before);
  if (change.after) json.member("after", *change.after);
  json.end_object();
}

void put_changes(JsonWriter& json, const std::vector<FileChange>& changes) {
  json.objects("changes", changes, [&](const FileChange& file) {
    json.member("file", file.file);
    if (!file.changes.empty()) {
      json.key("places");
      json.begin_array();
      for (const Change& change : file.changes) put_change(json, change);
      json.end_array();
    }
    if (file.more != 0) json.member("more", file.more);
  });
}

void put_reasons(JsonWriter& json, const Issue& issue) {
  if (issue.reasons.empty()) return;
  json.objects("reasons", issue.reasons, [&](const Issue::Reason& r) {
    json.member("finding", r.finding);
    json.member("reason", r.text);
    json.member("by", r.by);
  });
}

void put_register(JsonWriter& json, const Issue& issue) {
  if (issue.register_id.empty()) return;
  json.key("register");
  json.begin_object();
  json.member("id", issue.register_id);
  json.member("entry", issue.register_entry);
  json.member("sha256", issue.register_sha256);
  json.end_object();
}

std::string text_in(const storage::Json& object, const char* key) {
  return object.is_object() && object.contains(key) && object[key].is_string()
             ? object[key].get<std::string>()
             : "";
}

std::uint64_t count_in(const storage::Json& object, const char* key) {
  return object.contains(key) && object[key].is_number_unsigned() ? object[key].get<std::uint64_t>()
                                                                  : 0;
}

const storage::Json& list_in(const storage::Json& object, const char* key) {
  static const storage::Json none = storage::Json::array();
  return object.is_object() && object.contains(key) && object[key].is_array() ? object[key] : none;
}

FileChange change_in(const storage::Json& json) {
  // Before version 2 of the register, a change was written as a text.
  if (json.is_string()) return {json.get<std::string>()};
  FileChange file{text_in(json, "file")};
  for (const storage::Json& place : list_in(json, "places")) {
    if (!place.is_object()) continue;
    Change change{text_in(place, "key"), count_in(place, "line")};
    if (place.contains("before")) change.before = text_in(place, "before");
    if (place.contains("after")) change.after = text_in(place, "after");
    file.changes.push_back(std::move(change));
  }
  if (json.is_object()) file.more = count_in(json, "more");
  return file;
}

}  // namespace

void put_certificate(JsonWriter& json, const Certificate& certificate) {
  const Issue& issue = certificate.issue;
  json.key("certificate");
  json.begin_object();
  json.member("plugin", certificate.output);
  if (issue.is_draft()) {
    json.member("draft", true);
  } else {
    json.member("number", issue.number);
    json.member("date", issue.date);
  }
  put_if_there(json, "replaces", issue.replaces);
  put_if_there(json, "replaces_date", issue.replaces_date);
  put_if_there(json, "replaces_readings", issue.replaces_readings);
  put_if_there(json, "replaces_file", issue.replaces_file);
  put_if_there(json, "replaces_sha256", issue.replaces_sha256);
  if (!issue.replaces.empty()) {
    put_changes(json, issue.changes);
    put_if_there(json, "why", issue.why);
  }
  put_if_there(json, "released_by", issue.released_by);
  put_if_there(json, "author", issue.author);
  put_reasons(json, issue);
  json.member("readings_sha256", issue.readings_sha256);
  json.member("templates_sha256", certificate.templates_sha256);
  put_register(json, issue);
  json.end_object();
}

Certificate certificate_of(const storage::Json& json) {
  Certificate certificate;
  certificate.output = text_in(json, "plugin");
  certificate.templates_sha256 = text_in(json, "templates_sha256");
  Issue& issue = certificate.issue;
  issue.number = text_in(json, "number");
  issue.date = text_in(json, "date");
  issue.replaces = text_in(json, "replaces");
  issue.replaces_date = text_in(json, "replaces_date");
  issue.replaces_readings = text_in(json, "replaces_readings");
  issue.replaces_file = text_in(json, "replaces_file");
  issue.replaces_sha256 = text_in(json, "replaces_sha256");
  for (const storage::Json& change : list_in(json, "changes"))
    issue.changes.push_back(change_in(change));
  issue.readings_sha256 = text_in(json, "readings_sha256");
  issue.why = text_in(json, "why");
  issue.released_by = text_in(json, "released_by");
  issue.author = text_in(json, "author");
  for (const storage::Json& r : list_in(json, "reasons"))
    issue.reasons.push_back({text_in(r, "finding"), text_in(r, "reason"), text_in(r, "by")});
  if (json.is_object() && json.contains("register")) {
    issue.register_id = text_in(json["register"], "id");
    issue.register_entry = text_in(json["register"], "entry");
    issue.register_sha256 = text_in(json["register"], "sha256");
  }
  return certificate;
}

}  // namespace nonio::evaluation

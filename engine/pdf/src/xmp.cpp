// SPDX-License-Identifier: Apache-2.0
#include "xmp.h"

namespace nonio::pdf {
namespace {

std::string escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// An element, with its list in it if it has one; nothing if there is no text.
std::string element(std::string_view name, std::string_view text, std::string_view list = {}) {
  if (text.empty()) return {};
  const std::string tag(name), kind(list);
  const std::string item = kind == "Alt" ? "<rdf:li xml:lang=\"x-default\">" : "<rdf:li>";
  const std::string inner = escaped(text);
  return "   <" + tag + ">" +
         (kind.empty() ? inner
                       : "<rdf:" + kind + ">" + item + inner + "</rdf:li></rdf:" + kind + ">") +
         "</" + tag + ">\n";
}

}  // namespace

// No pdfaid schema: it would claim a conformance that no validator has seen.
std::string xmp_packet(const NewFile& file, std::string_view producer) {
  const std::string date = file.date.empty() ? "" : file.date + "T00:00:00Z";
  return "<?xpacket begin=\"\xEF\xBB\xBF\" id=\"W5M0MpCehiHzreSzNTczkc9d\"?>\n"
         "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n"
         " <rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
         "  <rdf:Description rdf:about=\"\" xmlns:dc=\"http://purl.org/dc/elements/1.1/\""
         " xmlns:xmp=\"http://ns.adobe.com/xap/1.0/\""
         " xmlns:pdf=\"http://ns.adobe.com/pdf/1.3/\">\n" +
         element("dc:title", file.title, "Alt") + element("dc:creator", file.author, "Seq") +
         element("dc:description", file.subject, "Alt") +
         element("dc:language", file.language, "Bag") + element("xmp:CreateDate", date) +
         element("pdf:Producer", producer) +
         "  </rdf:Description>\n </rdf:RDF>\n</x:xmpmeta>\n<?xpacket end=\"r\"?>\n";
}

}  // namespace nonio::pdf

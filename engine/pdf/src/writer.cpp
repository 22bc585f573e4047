// SPDX-License-Identifier: Apache-2.0
#include "nonio/pdf/writer.h"

#include <hpdf.h>
#include <hpdf_conf.h>
#include <hpdf_doc.h>
#include <hpdf_objects.h>
#include <hpdf_pages.h>
#include <hpdf_streams.h>

#include <charconv>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <deque>
#include <string_view>

#include "nonio/pdf/bytes.h"
#include "nonio/pdf/text.h"
#include "nonio/sdk/text.h"

// Only this file uses libharu. The text functions of libharu 2.3.0 are not used, because they parse
// and compress the fonts again for each document, omit glyphs without an error and write a
// CIDToGIDMap of 128 kB. Instead, the fonts are built from libharu objects with streams that were
// compressed once.

namespace nonio::pdf {
namespace {

std::string element(std::string_view name, std::string_view text, std::string_view list = {}) {
  if (text.empty()) return {};
  const std::string tag(name), kind(list);
  const std::string item = kind == "Alt" ? "<rdf:li xml:lang=\"x-default\">" : "<rdf:li>";
  const std::string inner = escaped_markup(text);
  return "   <" + tag + ">" +
         (kind.empty() ? inner
                       : "<rdf:" + kind + ">" + item + inner + "</rdf:li></rdf:" + kind + ">") +
         "</" + tag + ">\n";
}

/// Returns the document properties as XMP (ISO 16684-1), equal to those of the Info dictionary. The
/// pdfaid schema is omitted, because it would claim a conformance that no validator has confirmed.
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

/// Only the first error is stored, because libharu repeats it in every later call.
struct Failure {
  HPDF_STATUS code = HPDF_OK, detail = HPDF_OK;
};

void record(HPDF_STATUS code, HPDF_STATUS detail, void* user) {
  auto* failure = static_cast<Failure*>(user);
  if (failure->code == HPDF_OK) *failure = {code, detail};
}

/// Whether an allocation has failed since the document was begun. libharu may then report a
/// consequential error, or none.
bool memory_was_refused = false;

void* allocate(HPDF_UINT size) {
  void* const memory = std::malloc(size);
  memory_was_refused = memory_was_refused || memory == nullptr;
  return memory;
}

/// Content of a stream. The memory streams of libharu are not used, because they copy byte by byte.
struct Source {
  std::string_view bytes;
  std::size_t at = 0;
};

struct HaruDocument {
  Failure failure;
  std::deque<Source> sources;  ///< their bytes must outlive `doc`
  std::string bytes;
  HPDF_Doc doc = nullptr;
  HaruDocument() {
    memory_was_refused = false;
    doc = HPDF_NewEx(record, allocate, std::free, 0, &failure);
  }
  ~HaruDocument() {
    if (doc != nullptr) HPDF_Free(doc);
  }
  HaruDocument(const HaruDocument&) = delete;
  HaruDocument& operator=(const HaruDocument&) = delete;
};

HPDF_STATUS read_source(HPDF_Stream stream, HPDF_BYTE* to, HPDF_UINT* size) {
  auto& source = *static_cast<Source*>(stream->attr);
  const std::string_view part = source.bytes.substr(source.at, *size);
  std::memcpy(to, part.data(), part.size());
  source.at += part.size();
  *size = static_cast<HPDF_UINT>(part.size());
  return source.at == source.bytes.size() ? HPDF_STREAM_EOF : HPDF_OK;
}

HPDF_STATUS seek_source(HPDF_Stream stream, HPDF_INT at, HPDF_WhenceMode) {
  static_cast<Source*>(stream->attr)->at = static_cast<std::size_t>(at);
  return HPDF_OK;
}

HPDF_UINT32 size_of_source(HPDF_Stream stream) {
  return static_cast<HPDF_UINT32>(static_cast<Source*>(stream->attr)->bytes.size());
}

HPDF_STATUS append(HPDF_Stream stream, const HPDF_BYTE* bytes, HPDF_UINT size) {
  static_cast<std::string*>(stream->attr)->append(reinterpret_cast<const char*>(bytes), size);
  return HPDF_OK;
}

/// Writes the /Filter entry itself, because libharu removes a /Filter that it did not apply.
HPDF_STATUS write_filter(HPDF_Dict, HPDF_Stream stream) {
  return HPDF_Stream_WriteStr(stream, "/Filter /FlateDecode\012");
}
HPDF_STATUS write_jpeg_filter(HPDF_Dict, HPDF_Stream stream) {
  return HPDF_Stream_WriteStr(stream, "/Filter /DCTDecode\012");
}

HPDF_STATUS write_widths(HPDF_Dict dict, HPDF_Stream stream) {
  const auto* font = static_cast<const EmbeddedFont*>(dict->attr);
  HPDF_STATUS status = HPDF_Stream_WriteStr(stream, "/W ");
  if (status == HPDF_OK) status = HPDF_Stream_WriteStr(stream, font->widths.c_str());
  return status == HPDF_OK ? HPDF_Stream_WriteStr(stream, "\012") : status;
}

/// `bytes` must outlive the document; they are deflated if `compressed` is true.
void fill(HaruDocument& pdf, HPDF_Dict dict, const std::string& bytes, bool compressed = true) {
  Source& source = pdf.sources.emplace_back(Source{bytes});
  HPDF_Stream stream = HPDF_CallbackReader_New(pdf.doc->mmgr, read_source, seek_source, nullptr,
                                               size_of_source, &source);
  if (stream == nullptr) return;
  HPDF_Stream_Free(dict->stream);
  dict->stream = stream;
  dict->filter = HPDF_STREAM_FILTER_NONE;
  dict->write_fn = compressed ? write_filter : nullptr;
}

HPDF_Dict new_stream(HaruDocument& pdf, const std::string& bytes, bool compressed = true) {
  HPDF_Dict dict = HPDF_DictStream_New(pdf.doc->mmgr, pdf.doc->xref);
  if (dict != nullptr) fill(pdf, dict, bytes, compressed);
  return dict;
}

HPDF_Dict new_object(HPDF_Doc doc, const char* type) {
  HPDF_Dict dict = HPDF_Dict_New(doc->mmgr);
  if (dict == nullptr || HPDF_Xref_Add(doc->xref, dict) != HPDF_OK) return nullptr;
  if (type != nullptr) HPDF_Dict_AddName(dict, "Type", type);
  return dict;
}

HPDF_Dict add_descriptor(HaruDocument& pdf, const Font& font) {
  HPDF_Doc doc = pdf.doc;
  const EmbeddedFont& embedded = *font.embedded;
  HPDF_Dict file = new_stream(pdf, embedded.file_deflated);
  HPDF_Dict descriptor = new_object(doc, "FontDescriptor");
  if (file == nullptr || descriptor == nullptr) return nullptr;
  HPDF_Dict_AddNumber(file, "Length1", static_cast<HPDF_INT32>(embedded.size));
  HPDF_Dict_AddName(descriptor, "FontName", embedded.name.c_str());
  // Flag of a symbolic font, because glyphs are selected by number.
  HPDF_Dict_AddNumber(descriptor, "Flags", 4);
  HPDF_Array box = HPDF_Array_New(doc->mmgr);
  HPDF_Dict_Add(descriptor, "FontBBox", box);
  for (const int side : font.box) HPDF_Array_AddNumber(box, side);
  HPDF_Dict_AddNumber(descriptor, "ItalicAngle", 0);
  HPDF_Dict_AddNumber(descriptor, "Ascent", font.ascent);
  HPDF_Dict_AddNumber(descriptor, "Descent", font.descent);
  HPDF_Dict_AddNumber(descriptor, "CapHeight", font.cap_height);
  HPDF_Dict_AddNumber(descriptor, "StemV", font.stem);
  HPDF_Dict_Add(descriptor, "FontFile2", file);
  return descriptor;
}

/// Returns null on failure. `font.embedded` must outlive the document.
HPDF_Dict add_font(HaruDocument& pdf, const Font& font) {
  HPDF_Doc doc = pdf.doc;
  const EmbeddedFont& embedded = *font.embedded;
  HPDF_Dict descriptor = add_descriptor(pdf, font);
  HPDF_Dict to_unicode = new_stream(pdf, embedded.to_unicode_deflated);
  HPDF_Dict cid_font = new_object(doc, "Font"), type0 = new_object(doc, "Font");
  if (descriptor == nullptr || to_unicode == nullptr || cid_font == nullptr || type0 == nullptr)
    return nullptr;
  HPDF_Dict_AddName(cid_font, "Subtype", "CIDFontType2");
  HPDF_Dict_AddName(cid_font, "BaseFont", embedded.name.c_str());
  HPDF_Dict system = HPDF_Dict_New(doc->mmgr);
  HPDF_Dict_Add(cid_font, "CIDSystemInfo", system);
  HPDF_Dict_Add(system, "Registry", HPDF_String_New(doc->mmgr, "Adobe", nullptr));
  HPDF_Dict_Add(system, "Ordering", HPDF_String_New(doc->mmgr, "Identity", nullptr));
  HPDF_Dict_AddNumber(system, "Supplement", 0);
  HPDF_Dict_Add(cid_font, "FontDescriptor", descriptor);
  HPDF_Dict_AddName(cid_font, "CIDToGIDMap", "Identity");
  cid_font->attr = const_cast<EmbeddedFont*>(&embedded);
  cid_font->write_fn = write_widths;

  HPDF_Dict_AddName(type0, "Subtype", "Type0");
  HPDF_Dict_AddName(type0, "BaseFont", embedded.name.c_str());
  HPDF_Dict_AddName(type0, "Encoding", "Identity-H");
  HPDF_Array descendants = HPDF_Array_New(doc->mmgr);
  HPDF_Dict_Add(type0, "DescendantFonts", descendants);
  HPDF_Array_Add(descendants, cid_font);
  HPDF_Dict_Add(type0, "ToUnicode", to_unicode);
  return type0;
}

HPDF_Dict add_samples(HaruDocument& pdf, const Picture& picture, const std::string& compressed,
                      bool grey) {
  HPDF_Dict samples = new_stream(pdf, compressed);
  if (samples == nullptr) return nullptr;
  HPDF_Dict_AddName(samples, "Type", "XObject");
  HPDF_Dict_AddName(samples, "Subtype", "Image");
  HPDF_Dict_AddNumber(samples, "Width", static_cast<HPDF_INT32>(picture.width));
  HPDF_Dict_AddNumber(samples, "Height", static_cast<HPDF_INT32>(picture.height));
  HPDF_Dict_AddName(samples, "ColorSpace", grey ? "DeviceGray" : "DeviceRGB");
  HPDF_Dict_AddNumber(samples, "BitsPerComponent", 8);
  return samples;
}

HPDF_Dict add_picture(HaruDocument& pdf, const Picture& picture) {
  HPDF_Dict colours = add_samples(pdf, picture, picture.colours, picture.grey);
  if (colours == nullptr) return nullptr;
  if (picture.jpeg) colours->write_fn = write_jpeg_filter;
  if (!picture.opacity.empty())
    HPDF_Dict_Add(colours, "SMask", add_samples(pdf, picture, picture.opacity, true));
  return colours;
}

HPDF_Dict add_resources(HaruDocument& pdf, const NewFile& file) {
  HPDF_Doc doc = pdf.doc;
  HPDF_Dict resources = new_object(doc, nullptr);
  HPDF_Dict regular = add_font(pdf, file.fonts[0]), bold = add_font(pdf, file.fonts[1]);
  HPDF_Dict state = new_object(doc, "ExtGState");
  if (resources == nullptr || regular == nullptr || bold == nullptr || state == nullptr)
    return nullptr;
  HPDF_Dict by_font = HPDF_Dict_New(doc->mmgr);
  HPDF_Dict_Add(resources, "Font", by_font);
  HPDF_Dict_Add(by_font, "F1", regular);
  HPDF_Dict_Add(by_font, "F2", bold);
  if (file.fonts[2].embedded != nullptr) HPDF_Dict_Add(by_font, "F3", add_font(pdf, file.fonts[2]));
  if (!file.pictures.empty()) {
    HPDF_Dict by_picture = HPDF_Dict_New(doc->mmgr);
    HPDF_Dict_Add(resources, "XObject", by_picture);
    for (std::size_t i = 0; i < file.pictures.size(); ++i)
      HPDF_Dict_Add(by_picture, ("P" + std::to_string(i)).c_str(),
                    add_picture(pdf, *file.pictures[i]));
  }
  HPDF_Dict_AddReal(state, "ca", static_cast<HPDF_REAL>(file.see_through));
  HPDF_Dict by_state = HPDF_Dict_New(doc->mmgr);
  HPDF_Dict_Add(resources, "ExtGState", by_state);
  HPDF_Dict_Add(by_state, "G1", state);
  return resources;
}

void add_property(HPDF_Doc doc, const char* key, std::string_view text) {
  if (text.empty()) return;
  std::string bytes = utf16(text).value_or("");  // invalid UTF-8 is reported when the text is drawn
  HPDF_Dict_Add(doc->info, key,
                HPDF_Binary_New(doc->mmgr, reinterpret_cast<HPDF_BYTE*>(bytes.data()),
                                static_cast<HPDF_UINT>(bytes.size())));
}

/// Shortens a property to at most 2000 bytes of whole UTF-8 characters; the document itself
/// contains the whole text.
std::string label(std::string text) {
  constexpr std::size_t most = 2000;
  if (text.size() <= most) return text;
  std::size_t end = most;
  while ((static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
  text.resize(end);
  return text;
}

std::optional<HPDF_Date> date_of(const std::string& text) {
  HPDF_Date date{};
  date.ind = 'Z';
  const auto part = [&](std::size_t at, std::size_t size, HPDF_INT& value) {
    const char* from = text.data() + at;
    return std::from_chars(from, from + size, value).ptr == from + size;
  };
  if (text.size() == 10 && part(0, 4, date.year) && part(5, 2, date.month) &&
      part(8, 2, date.day) &&
      std::chrono::year_month_day(std::chrono::year(date.year),
                                  std::chrono::month(static_cast<unsigned>(date.month)),
                                  std::chrono::day(static_cast<unsigned>(date.day)))
          .ok())
    return date;
  return {};
}

void add_properties(HPDF_Doc doc, const NewFile& file) {
  add_property(doc, "Title", file.title);
  add_property(doc, "Author", file.author);
  add_property(doc, "Subject", file.subject);
  if (const auto date = date_of(file.date))
    HPDF_SetInfoDateAttr(doc, HPDF_INFO_CREATION_DATE, *date);
  if (!file.language.empty())
    HPDF_Dict_Add(doc->catalog, "Lang", HPDF_String_New(doc->mmgr, file.language.c_str(), nullptr));
}

struct Kept {
  std::string profile, xmp, identifier;
};

Kept kept_of(HPDF_Doc doc, const NewFile& file, const std::vector<std::string>& contents,
             const Deflater& fast) {
  const char* producer = HPDF_GetInfoAttr(doc, HPDF_INFO_PRODUCER);
  Kept kept{fast(file.profile), xmp_packet(file, producer != nullptr ? producer : ""), {}};
  std::string content = kept.xmp;
  for (const std::string& page : contents) content += page;
  kept.identifier = sha256(content).substr(0, 16);
  return kept;
}

void add_kept(HaruDocument& pdf, const Kept& kept) {
  HPDF_Doc doc = pdf.doc;
  HPDF_Dict profile = new_stream(pdf, kept.profile), metadata = new_stream(pdf, kept.xmp, false);
  HPDF_Dict intent = new_object(doc, "OutputIntent");
  if (profile == nullptr || metadata == nullptr || intent == nullptr) return;
  HPDF_Dict_AddNumber(profile, "N", 3);
  HPDF_Dict_AddName(metadata, "Type", "Metadata");
  HPDF_Dict_AddName(metadata, "Subtype", "XML");
  HPDF_Dict_Add(doc->catalog, "Metadata", metadata);
  HPDF_Dict_AddName(intent, "S", "GTS_PDFA1");
  const auto text = [&](const char* value) { return HPDF_String_New(doc->mmgr, value, nullptr); };
  HPDF_Dict_Add(intent, "OutputConditionIdentifier", text("sRGB IEC61966-2.1"));
  HPDF_Dict_Add(intent, "Info", text("sRGB IEC61966-2.1"));
  HPDF_Dict_Add(intent, "DestOutputProfile", profile);
  HPDF_Array intents = HPDF_Array_New(doc->mmgr);
  HPDF_Dict_Add(doc->catalog, "OutputIntents", intents);
  HPDF_Array_Add(intents, intent);
  HPDF_Array identifiers = HPDF_Array_New(doc->mmgr);
  HPDF_Dict_Add(doc->trailer, "ID", identifiers);
  for (int i = 0; i < 2; ++i) {
    std::string bytes = kept.identifier;
    HPDF_Array_Add(identifiers,
                   HPDF_Binary_New(doc->mmgr, reinterpret_cast<HPDF_BYTE*>(bytes.data()),
                                   static_cast<HPDF_UINT>(bytes.size())));
  }
}

void add_page(HaruDocument& pdf, const NewFile& file, std::size_t number,
              const std::string& compressed, HPDF_Dict resources) {
  HPDF_Page page = HPDF_AddPage(pdf.doc);
  if (page == nullptr) return;
  HPDF_Page_SetWidth(page, static_cast<HPDF_REAL>(file.width));
  HPDF_Page_SetHeight(page, static_cast<HPDF_REAL>(file.height));
  HPDF_Dict_RemoveElement(page, "Resources");
  HPDF_Dict_Add(page, "Resources", resources);
  if (file.signature && file.signature->page == number) {
    HPDF_Array corners = HPDF_Array_New(pdf.doc->mmgr);
    HPDF_Dict_Add(page, signature_key, corners);
    const SignaturePlace& s = *file.signature;
    for (const double v : {s.left, s.low, s.right, s.high})
      HPDF_Array_AddNumber(corners, static_cast<HPDF_INT32>(std::lround(v)));
  }
  fill(pdf, static_cast<HPDF_PageAttr>(page->attr)->contents, compressed);
}

}  // namespace

Expected<std::string> write(NewFile file) {
  for (std::string* text : {&file.title, &file.author, &file.subject})
    *text = label(std::move(*text));
  if (!date_of(file.date)) file.date.clear();
  std::vector<std::string> contents;
  const Deflater fast(1);  // level 6 takes three times as long and saves only a few percent
  for (const std::string& content : file.pages) contents.push_back(fast(content));
  Kept kept;  // must outlive `pdf`
  HaruDocument pdf;
  if (pdf.doc == nullptr) return fail("the PDF could not be begun: out of memory");
  pdf.doc->pdf_version = HPDF_VER_17;
  add_properties(pdf.doc, file);
  if (!file.profile.empty()) add_kept(pdf, kept = kept_of(pdf.doc, file, contents, fast));
  if (HPDF_Dict resources = add_resources(pdf, file)) {
    for (std::size_t i = 0; i < contents.size(); ++i)
      add_page(pdf, file, i, contents[i], resources);
    pdf.doc->stream = HPDF_CallbackWriter_New(pdf.doc->mmgr, append, &pdf.bytes);
    if (pdf.failure.code == HPDF_OK) HPDF_SaveToStream(pdf.doc);
  }
  if (memory_was_refused) return fail("the PDF could not be written: out of memory");
  if (pdf.failure.code != HPDF_OK || pdf.bytes.empty()) {
    std::array<char, 16> code{};
    std::to_chars(code.data(), code.data() + code.size() - 1, pdf.failure.code, 16);
    return fail("the PDF could not be written: libharu error 0x" + std::string(code.data()) +
                ", detail " + std::to_string(pdf.failure.detail));
  }
  return std::move(pdf.bytes);
}

}  // namespace nonio::pdf

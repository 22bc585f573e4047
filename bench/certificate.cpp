// SPDX-License-Identifier: Apache-2.0
// CPU time of a certificate of three pages, on one core: `bench_certificate FOLDER [COUNT]`. Leaves
// certificate.pdf in FOLDER for bench/certificate.py, which does the same with ReportLab, and
// prints milliseconds for each stage: the median of batches of ten.
#include <libdeflate.h>
#include <time.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <functional>
#include <memory>

#include "authority.h"
#include "certificate_case.h"
#include "nonio/sign/sign.h"
#include "pdf_reader.h"

namespace {

using namespace nonio;

int count = 30;  // batches

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) * 1e3 + static_cast<double>(t.tv_nsec) / 1e6;
}

double median_ms(const std::function<void()>& work) {
  constexpr int batch = 10;
  work();
  std::vector<double> times;
  for (int i = 0; i < count; ++i) {
    const double before = cpu_ms();
    for (int k = 0; k < batch; ++k) work();
    times.push_back((cpu_ms() - before) / batch);
  }
  std::nth_element(times.begin(), times.begin() + count / 2, times.end());
  return times[static_cast<std::size_t>(count) / 2];
}

void say(const char* stage, double ms) { std::printf("%-28s %7.3f ms\n", stage, ms); }

struct Bench {
  fixtures::Plugins plugins;
  Templates templates = fixtures::read_templates(NONIO_TEMPLATES);
  Issue issue{"2026-0012", "2026-11-21", "", "", {}, std::string(64, 'a')};
  Settings none;
  fixtures::Case campaign;

  std::string certificate(const std::string& language, const Templates& with) {
    campaign.campaign.certificate.languages = {language};
    for (const Output& output : plugins.outputs)
      if (output.info.name == "certificate") {
        const auto result = output.write(
            {campaign.campaign, campaign.observations, campaign.results, none, with, &issue});
        if (result) return result->artifacts.front().bytes;
        std::fprintf(stderr, "%s\n", result.error().message.c_str());
      }
    std::exit(1);
  }
  std::size_t dcc() {
    for (const Output& output : plugins.outputs)
      if (output.info.name == "dcc")
        if (const auto result = output.write({campaign.campaign, campaign.observations,
                                              campaign.results, none, templates, &issue}))
          return result->artifacts.front().bytes.size();
    return 0;
  }
};

/// The pages' contents as they are compressed.
double flate_ms(const std::string& pdf) {
  std::vector<std::string> pages;
  for (std::string& stream : fixtures::streams(pdf))
    if (stream.find("BT ") != std::string::npos) pages.push_back(std::move(stream));
  return median_ms([&] {
    for (const std::string& page : pages) {
      const std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> c(
          libdeflate_alloc_compressor(1), &libdeflate_free_compressor);
      std::string out(libdeflate_zlib_compress_bound(c.get(), page.size()), '\0');
      libdeflate_zlib_compress(c.get(), page.data(), page.size(), out.data(), out.size());
    }
  });
}

double signing_ms(const std::string& pdf, const std::string& kind) {
  const sign_tests::Holder root = sign_tests::authority("Root");
  sign_tests::Wish wish;
  wish.key = kind;
  const sign::Key key = sign_tests::open(sign_tests::issue(wish, &root), root);
  const auto reserved = pdf::reserve(pdf, {}, sign_tests::now);
  return median_ms([&] {
    if (!reserved || !key.sign(*reserved, sign_tests::now)) std::exit(1);
  });
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return std::fprintf(stderr, "usage: bench_certificate FOLDER [COUNT]\n"), 2;
  if (argc > 2) std::from_chars(argv[2], argv[2] + std::string_view(argv[2]).size(), count);
  Bench b;
  for (const char* name : {"iso230-2", "certificate", "dcc"})
    if (!b.plugins.load(NONIO_PLUGINS, name)) return 1;
  b.campaign = fixtures::whole_case(b.plugins);
  b.campaign.add("Y", {});
  b.campaign.campaign.machine.axes.back().expansion = 11.5e-6;
  b.campaign.results = {};
  b.campaign.analyse(b.plugins);

  const double before = cpu_ms();
  const std::string pdf = b.certificate("en", b.templates);
  const double first = cpu_ms() - before;
  std::ofstream(std::string(argv[1]) + "/certificate.pdf", std::ios::binary) << pdf;
  Templates bare = b.templates;
  bare.tables["certificate"].values["plots"] = std::vector<std::string>{};
  std::printf("pages %zu, bytes %zu\n", fixtures::read_pdf(pdf).pages.size(), pdf.size());

  const auto timed = [&](const char* language, const Templates& with) {
    return median_ms([&] { b.certificate(language, with); });
  };
  say("first PDF and DCC", first);
  say("PDF and DCC", timed("en", b.templates));
  say("the same without plots", timed("en", bare));
  say("the same in Chinese", timed("zh", b.templates));
  say("DCC", median_ms([&] { b.dcc(); }));
  say("Flate of the pages", flate_ms(pdf));
  say("room for a signature", median_ms([&] { (void)pdf::reserve(pdf, {}, sign_tests::now); }));
  say("CMS, P-256", signing_ms(pdf, "P-256"));
  say("CMS, RSA-3072", signing_ms(pdf, "RSA-3072"));
  return 0;
}

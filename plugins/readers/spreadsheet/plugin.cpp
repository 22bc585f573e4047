// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

#include "csv.h"
#include "spreadsheet.h"

namespace nonio::spreadsheet_reader {

NONIO_PLUGIN(registry) {
  Reader r;
  r.info = {"spreadsheet",
            "1.0",
            "Excel workbooks (XLSX) and OpenDocument spreadsheets (ODS) with the columns of csv",
            {{"sheet", std::string(), "",
              "The sheet with the readings. Default: the only one with known column names."}}};
  r.recognises = spreadsheet::recognises;
  r.reads = csv::reads;
  r.read = spreadsheet::read;
  r.reads_columns = true;
  registry.add(r);
}

}  // namespace nonio::spreadsheet_reader

// SPDX-License-Identifier: Apache-2.0
#include "nonio/sdk/plugin.h"

#include "csv.h"
#include "spreadsheet.h"

namespace nonio::spreadsheet_reader {

NONIO_PLUGIN(registry) {
  Reader r;
  r.info = {"spreadsheet",
            "1.2",
            "Excel workbooks (XLSX) and OpenDocument spreadsheets (ODS) with the columns of csv",
            {{"sheet", std::string(), "",
              "The sheet with the readings. Default: the only one with known column names."},
             csv::columns_declared()}};
  r.recognises = spreadsheet::recognises;
  r.reads = csv::reads;
  r.read = spreadsheet::read;
  r.reads_columns = true;
  r.first_rows = spreadsheet::first_rows;
  registry.add(r);
}

}  // namespace nonio::spreadsheet_reader

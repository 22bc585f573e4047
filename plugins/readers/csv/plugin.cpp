// SPDX-License-Identifier: Apache-2.0
#include "csv.h"

namespace nonio::csv_reader {

NONIO_PLUGIN(registry) {
  Reader reader;
  reader.info = {"csv",
                 "1.1",
                 "Readings of every kind of measurement as comma-separated values.",
                 {csv::columns_declared()}};
  reader.recognises = csv::recognises;
  reader.reads = csv::reads;
  reader.read = csv::read;
  reader.reads_columns = true;
  reader.first_rows = csv::first_rows;
  registry.add(std::move(reader));
}

}  // namespace nonio::csv_reader

// SPDX-License-Identifier: Apache-2.0
#include "csv.h"

NONIO_PLUGIN(registry) {
  nonio::Reader reader;
  reader.info = {"csv", "1.0", "Readings of every kind of measurement as comma-separated values."};
  reader.recognises = nonio::csv::recognises;
  reader.reads = nonio::csv::reads;
  reader.read = nonio::csv::read;
  reader.reads_columns = true;
  registry.add(std::move(reader));
}

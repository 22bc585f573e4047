// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fixtures.h"

namespace nonio::fixtures {

/// One axis, with everything that a certificate needs.
inline Case whole_case(const Plugins& plugins) {
  Case c = simple_case();
  c.add("X", {});
  Campaign& m = c.campaign;
  m.customer_address = "Via Po 1, Torino";
  m.received = "2026-11-01";
  m.end_date = "2026-11-04";
  m.machine.condition = "in use";
  m.machine.axes[0].expansion = 11.5e-6;
  m.environment = {1e-3, 0.2, 1.5, 1e-6, 1e-6, {}};
  m.laboratory = {"Taratura Srl", "Via Dora 2, Torino", "IT", "", "B. Verdi", "info@example.org"};
  m.certificate.languages = {"en"};
  m.certificate.form = "certificate";
  m.certificate.location = "customer";
  c.analyse(plugins);
  return c;
}

}  // namespace nonio::fixtures

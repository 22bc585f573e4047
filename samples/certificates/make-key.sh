#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# A throwaway key for this sample, signed by a root that is thrown away at once. It proves nothing: the
# key of a laboratory comes from an authority that its customers trust.
set -euo pipefail
cd "$(dirname "$0")"
umask 077
mkdir -p keys
cd keys
openssl rand -hex 16 > password
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -days 3650 -keyout root.key -out root.pem \
  -subj "/O=Sample Authority/CN=Sample Root" -addext basicConstraints=critical,CA:TRUE \
  -addext keyUsage=critical,keyCertSign,cRLSign 2> /dev/null
openssl req -newkey ec -pkeyopt ec_paramgen_curve:P-256 -nodes -keyout lab.key -out lab.csr \
  -subj "/O=Sample Calibration Laboratory/CN=B. Sample" 2> /dev/null
openssl x509 -req -in lab.csr -CA root.pem -CAkey root.key -CAcreateserial -days 730 -out lab.pem -extfile <(
  printf 'basicConstraints=critical,CA:FALSE\nkeyUsage=critical,digitalSignature,nonRepudiation\n'
  printf 'extendedKeyUsage=emailProtection,1.3.6.1.5.5.7.3.36\n') 2> /dev/null
openssl pkcs12 -export -in lab.pem -inkey lab.key -out lab.p12 -passout file:password
rm root.key lab.key lab.csr lab.pem root.srl

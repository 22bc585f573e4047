// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "campaign/config/site_files.h"
#include "campaign/config/site_logs.h"
#include "campaign/evaluation/evaluate.h"
#include "certificates/register.h"
#include "laboratory/assessment/history_so_far.h"
#include "laboratory/store/store.h"
#include "nonio/sdk/history.h"
#include "nonio/sdk/plugin.h"
#include "platform/storage/serialise.h"

/// Members of the types that the processes of a run exchange.
namespace nonio::storage {

NONIO_MEMBERS(Error, a, b, c, d, e)
NONIO_MEMBERS(Number, a, b, c)
NONIO_MEMBERS(Followed, a, b, c, d)
NONIO_MEMBERS(JudgedLimit, a, b)
NONIO_MEMBERS(Value, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(Finding, a, b, c, d, e, f)
NONIO_MEMBERS(Remark, a, b, c, d, e)
NONIO_MEMBERS(PointTable::Column, a, b, c, d)
NONIO_MEMBERS(PointTable, a)
NONIO_MEMBERS(Series, a, b, c, d, e, f, g, h, i)
NONIO_MEMBERS(Contribution, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(UncertaintyBudget::Result, a, b, c, d, e)
NONIO_MEMBERS(UncertaintyBudget, a, b, c, d)
NONIO_MEMBERS(Evaluation, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(Prediction, a, b, c, d, e)
NONIO_MEMBERS(Artifact, a, b, c)
NONIO_MEMBERS(OutputResult, a, b, c, d)
NONIO_MEMBERS(Change, a, b, c, d)
NONIO_MEMBERS(FileChange, a, b, c)
NONIO_MEMBERS(Issue::Reason, a, b, c)
NONIO_MEMBERS(Issue, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p)
NONIO_MEMBERS(Conformity, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(ModelFit::Parameter, a, b, c, d, e, f)
NONIO_MEMBERS(ModelFit::Curve, a, b, c, d, e)
NONIO_MEMBERS(ModelFit::Effect, a, b, c, d, e)
NONIO_MEMBERS(ModelFit::Without, a, b, c, d, e, f, g, h, i, j)
NONIO_MEMBERS(ModelFit::Candidate, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(ModelFit::Step, a, b, c)
NONIO_MEMBERS(ModelFit::Suspect, a, b)
NONIO_MEMBERS(ModelFit::Channel, a, b, c, d)
NONIO_MEMBERS(ModelFit, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x, y,
              z, aa, bb, cc, dd, ee, ff, gg)
NONIO_MEMBERS(Results::Analysed, a, b, c, d, e)
NONIO_MEMBERS(Results::Written, a, b, c)
NONIO_MEMBERS(Results, a, b, c, d, e, f)

NONIO_MEMBERS(Axis, a, b, c, d, e, f, g, h, i, j, k)
NONIO_MEMBERS(Machine, a, b, c, d, e, f, g, h, i)
NONIO_MEMBERS(Instrument, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
NONIO_MEMBERS(Sensor, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(Square, a, b, c)
NONIO_MEMBERS(Environment, a, b, c, d, e, f, g, h, i, j)
NONIO_MEMBERS(Cmc, a, b, c)
NONIO_MEMBERS(Laboratory, a, b, c, d, e, f, g)
NONIO_MEMBERS(CertificateTexts, a, b, c, d, e, f, g, h, i, j, k, l)
NONIO_MEMBERS(Tolerance, a, b, c)
NONIO_MEMBERS(Settings, a)
NONIO_MEMBERS(Measurement::Channel, a, b, c)
NONIO_MEMBERS(Measurement, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s, t, u, v, w, x,
              y, z, aa, bb, cc, dd)
NONIO_MEMBERS(Formula::Parameter, a, b, c, d)
NONIO_MEMBERS(Formula, a, b, c, d, e)
NONIO_MEMBERS(Campaign, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o, p, q, r, s)

NONIO_MEMBERS(HistoryPoint, a, b, c, d, e, f, g, h, i)
NONIO_MEMBERS(HistorySegment, a, b, c, d, e, f, g, h, i, j)
NONIO_MEMBERS(HistoryChange, a, b, c, d, e, f, g, h, i, j, k)
NONIO_MEMBERS(HistoryForecast, a, b, c, d, e, f, g)
NONIO_MEMBERS(HistorySeries::Over, a, b)
NONIO_MEMBERS(HistorySeries, a, b, c, d, e, f, g, h, i, j, k, l, m)
NONIO_MEMBERS(MachineEvent, a, b, c, d)
NONIO_MEMBERS(HistoryStep, a, b, c, d, e, f, g, h, i)
NONIO_MEMBERS(HistorySoFar, a, b, c, d, e, f, g, h, i, j)

NONIO_MEMBERS(evaluation::IssuedFile, a, b, c, d)
NONIO_MEMBERS(evaluation::Certificate, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(evaluation::AssignedNumber, a, b, c)
NONIO_MEMBERS(evaluation::FollowedQuantity::Common, a, b)
NONIO_MEMBERS(evaluation::FollowedQuantity, a, b, c, d, e, f, g, h, i, j, k)
NONIO_MEMBERS(evaluation::ComparedTargets::Fit, a, b, c, d, e, f, g)
NONIO_MEMBERS(evaluation::ComparedTargets, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(evaluation::FollowedGroup, a, b, c)
NONIO_MEMBERS(evaluation::ShownHistory, a, b)
NONIO_MEMBERS(evaluation::AxisCorrection, a, b, c, d)
NONIO_MEMBERS(evaluation::ControlTables, a, b, c, d, e, f, g, h, i, j, k)
NONIO_MEMBERS(evaluation::Evaluated, a, b, c, d, e, f, g, h, i, j)

NONIO_MEMBERS(config::TemplateFiles, a, b)
NONIO_MEMBERS(config::SiteFiles, a, b)
NONIO_MEMBERS(config::Event, a, b, c, d, e, f, g)
NONIO_MEMBERS(config::Acknowledgement, a, b, c, d, e, f, g, h, i, j, k)
NONIO_MEMBERS(config::Forgotten, a, b, c, d, e)
NONIO_MEMBERS(config::SiteLogs, a, b, c)
NONIO_MEMBERS(store::Updated, a, b, c)
NONIO_MEMBERS(store::MachineAsStated, a, b, c, d)
NONIO_MEMBERS(store::NamedMachine, a, b, c)
NONIO_MEMBERS(assessment::HistoryBasis, a, b, c, d, e, f, g, h)
NONIO_MEMBERS(evaluation::KnownFinding, a, b, c, d, e)
NONIO_MEMBERS(certificates::Approval, a, b, c, d, e, f)
NONIO_MEMBERS(certificates::RegisterEntry, a, b, c, d, e, f, g, h, i, j, k, l, m, n, o)
NONIO_MEMBERS(certificates::WaitingDraft, a, b, c, d, e, f, g, h, i)

NONIO_MEMBERS(Option, a, b, c, d, e, f, g, h, i, j, k)
NONIO_MEMBERS(Info, a, b, c, d, e)
NONIO_MEMBERS(loader::PluginFile, a, b, c)
NONIO_MEMBERS(loader::Catalogue, a, b, c, d, e, f, g, h, i)

}  // namespace nonio::storage

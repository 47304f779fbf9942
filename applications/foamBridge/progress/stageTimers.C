/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stageTimers.H"

#include "foamParams.H"
#include "particleCase.H"

namespace Foam
{

stageTimers::stageTimers()
:
  timers_(nullptr),
  running_(-1)
{
  checkStatus(part_timers_create(&timers_), "stageTimers");
}

stageTimers::~stageTimers() { part_timers_destroy(timers_); }

void stageTimers::next(const char* name)
{
  stop();
  checkStatus(part_timers_stage(timers_, name, &running_), "stageTimers");
  part_timers_start(timers_, running_);
}

void stageTimers::stop()
{
  if (running_ >= 0) part_timers_stop(timers_, running_);
  running_ = -1;
}

void stageTimers::report(Ostream& os) const
{
  char text[4096];
  checkStatus
  (
    part_timers_report(timers_, particleCommunicator(), sizeof text, text), "stageTimers"
  );
  os << nl << text;
}

} // namespace Foam

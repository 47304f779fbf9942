/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "progress.H"

namespace Foam
{

progress::progress(const Time& time)
:
  time_(time),
  startValue_(time.value()),
  startClock_(time.elapsedClockTime()),
  lastClock_(time.elapsedCpuTime()),
  particleSteps_(0),
  rate_(0)
{}

static string hours(scalar seconds)
{
  char text[32];
  const long s = long(seconds + 0.5);
  snprintf(text, sizeof text, "%ld:%02ld:%02ld", s/3600, s/60 % 60, s % 60);
  return text;
}

void progress::report(Ostream& os, scalar particleSteps)
{
  const scalar cpu = time_.elapsedCpuTime();
  const scalar wall = time_.elapsedClockTime() - startClock_;
  const scalar done = time_.value() - startValue_;
  const scalar all = time_.endTime().value() - startValue_;
  particleSteps_ += particleSteps;
  if (cpu - lastClock_ > 0.5) // the clock counts in hundredths: a mean over at least half a second
  {
    rate_ = particleSteps_/(cpu - lastClock_);
    particleSteps_ = 0;
    lastClock_ = cpu;
  }
  os << "Progress: " << 100*done/max(all, VSMALL) << " %, ExecutionTime = " << cpu
     << " s, ClockTime = " << time_.elapsedClockTime() << " s, " << rate_
     << " particle-steps/s, time left "
     << hours(wall*max(all - done, scalar(0))/max(done, VSMALL)).c_str() << nl << endl;
}

} // namespace Foam

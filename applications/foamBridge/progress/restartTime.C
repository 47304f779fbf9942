/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "restartTime.H"

#include "IOstream.H"

namespace Foam
{

static scalar rounded(int digits, scalar value)
{
  char text[64];
  snprintf(text, sizeof text, "%.*g", digits, value);
  return strtod(text, nullptr);
}

void roundDeltaT(Time& time)
{
  if (time.isAdjustTimeStep()) time.setDeltaT(rounded(12, time.deltaTValue()), false);
}

void restartTime(Time& time)
{
  if (!time.writeTime()) return;
  time.setTime(time.userTimeToTime(strtod(time.timeName().c_str(), nullptr)), time.timeIndex());
  if (time.isAdjustTimeStep())
  {
    time.setDeltaT(rounded(IOstream::defaultPrecision(), time.deltaTValue()), false);
  }
}

} // namespace Foam

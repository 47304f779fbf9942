/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "particleFiles.H"

#include "OSspecific.H"
#include "fileOperation.H"

namespace Foam
{

particleFiles::particleFiles(const Time& time, const word& name)
:
  time_(time),
  name_(name),
  folder_(time.globalPath()/name)
{}

void particleFiles::purge()
{
  if (Pstream::master()) mkDir(folder_);
  const label keep = time_.controlDict().getOrDefault<label>("purgeWrite", 0);
  if (keep <= 0) return;
  if (written_.empty() || written_.last() != time_.timeName()) written_.append(time_.timeName());
  DynamicList<word> kept;
  forAll(written_, i)
  {
    // a directory that could not be removed keeps its particles
    const bool gone = fileHandler().filePath(time_.path()/written_[i]).empty();
    if (i + keep < written_.size() && gone)
    {
      if (Pstream::master()) rm(at(written_[i]));
    }
    else
    {
      kept.append(written_[i]);
    }
  }
  written_.transfer(kept);
}

} // namespace Foam

/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "frozenFlow.H"

#include "foamParams.H"

namespace Foam
{

frozenFlow::frozenFlow(const fvMesh& mesh, const dictionary& dict)
:
  mesh_(mesh),
  dict_(dict),
  source_(),
  times_(),
  pressureName_(dict.getOrDefault<word>("pressure", "p_rgh")),
  repeat_(dict.getOrDefault<Switch>("repeat", false)),
  at_(-1)
{
  checkEntries(dict, wordList({"case", "pressure", "repeat"}));
  if (dict.found("case"))
  {
    openSource();
    return;
  }
  for (const word& entry : {word("pressure"), word("repeat")})
  {
    if (!dict.found(entry)) continue;
    FatalIOErrorInFunction(dict)
        << "entry '" << entry << "' needs entry 'case': without it U and p_rgh of the start time stay"
        << exit(FatalIOError);
  }
}

void frozenFlow::openSource()
{
  const Time& runTime = mesh_.time();
  fileName path(dict_.get<fileName>("case"));
  if (!path.isAbsolute()) path = runTime.globalPath()/path;
  path.clean();
  fileName name(path.name());
  if (Pstream::parRun()) name = name/("processor" + Foam::name(Pstream::myProcNo()));
  if (!returnReduce(isFile(path/"system"/"controlDict"), andOp<bool>()))
  {
    FatalIOErrorInFunction(dict_)
        << "entry 'case' is " << path << ", which is no OpenFOAM case (it has no system/controlDict)"
        << exit(FatalIOError);
  }
  source_.reset(new Time(Time::controlDictName, path.path(), name, word("system"), word("constant"), false, false));
  DynamicList<instant> found;
  for (const instant& i : source_->times())
  {
    if (i.name() != source_->constant() && isFile(source_->path()/i.name()/"U")) found.append(i);
  }
  times_ = found;
  if (!returnReduce(times_.size(), minOp<label>()))
  {
    FatalIOErrorInFunction(dict_)
        << "entry 'case': no time of " << source_->path() << " has a field U"
        << (Pstream::parRun() ? " (decompose that case as this one)" : "") << exit(FatalIOError);
  }
}

template<class Field>
autoPtr<Field> frozenFlow::read(const word& name, label time) const
{
  autoPtr<Field> field
  (
    new Field
    (
      IOobject(name, times_[time].name(), source_(), IOobject::MUST_READ, IOobject::NO_WRITE, false),
      mesh_
    )
  );
  return field;
}

/* times_[index] <= time < times_[index + 1], part of the way between them. */
void frozenFlow::bracket(scalar time, label& index, scalar& part) const
{
  const label last = times_.size() - 1;
  const scalar first = times_[0].value(), length = times_[last].value() - first;
  index = 0;
  part = 0;
  if (last == 0) return; // one time: steady
  if (repeat_)
  {
    time = first + fmod(time - first, length);
    if (time < first) time += length;
  }
  else if (time < first - SMALL || time > times_[last].value() + SMALL)
  {
    FatalIOErrorInFunction(dict_)
        << "time " << time << " is outside the times of " << source_->path() << ", " << first << " to "
        << times_[last].value() << "; allowed: a run within them, or 'repeat on'" << exit(FatalIOError);
  }
  while (index < last - 1 && times_[index + 1].value() <= time) ++index;
  const scalar t0 = times_[index].value(), t1 = times_[index + 1].value();
  part = min(max((time - t0)/(t1 - t0), scalar(0)), scalar(1));
}

void frozenFlow::update(scalar time, volVectorField& U, volScalarField& p_rgh)
{
  if (!source_.valid()) return;
  label index;
  scalar part;
  bracket(time, index, part);
  const bool series = times_.size() > 1;
  if (index != at_)
  {
    U0_ = read<volVectorField>("U", index);
    p0_ = read<volScalarField>(pressureName_, index);
    checkDimensions(U0_(), U0_->dimensions(), dimVelocity);
    checkDimensions(p0_(), p0_->dimensions(), dimVelocity*dimVelocity);
    if (series)
    {
      U1_ = read<volVectorField>("U", index + 1);
      p1_ = read<volScalarField>(pressureName_, index + 1);
    }
    at_ = index;
  }
  else if (!series)
  {
    return;
  }
  if (series)
  {
    U == (1 - part)*U0_() + part*U1_();
    p_rgh == (1 - part)*p0_() + part*p1_();
  }
  else
  {
    U == U0_();
    p_rgh == p0_();
  }
}

void frozenFlow::reportPlan(Ostream& os) const
{
  os << "flow equations | frozenFlow, ";
  if (!source_.valid()) os << "fields of the start time";
  else if (times_.size() == 1) os << "one time of " << source_->path();
  else os << times_.size() << " times of " << source_->path();
  os << " | the whole solution of the flow" << nl;
}

} // namespace Foam

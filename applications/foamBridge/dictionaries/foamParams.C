/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foamParams.H"

#include "DynamicList.H"
#include "Switch.H"
#include "dimensionSet.H"
#include "vector.H"

namespace Foam
{

void checkStatus(int status, const char* where)
{
  if (status == PART_OK) return;
  FatalErrorIn(where) << part_last_error() << nl << "(" << part_status_text(status) << ")"
                      << exit(FatalError);
}

void checkStatus(int status, const dictionary& dict)
{
  if (status == PART_OK) return;
  FatalIOErrorInFunction(dict) << part_last_error() << exit(FatalIOError);
}

static dimensionSet rowDimensions(const part_param& row)
{
  return dimensionSet
  (
    row.dims[0], row.dims[1], row.dims[2], row.dims[3], row.dims[4], row.dims[5], row.dims[6]
  );
}

/* [dimensions] before the value: must be those of the row. */
static void readDimensions(const dictionary& dict, const part_param& row, Istream& is)
{
  token first(is);
  is.putBack(first);
  if (first != token::BEGIN_SQR) return;
  dimensionSet given(dimless);
  scalar multiplier = 1;
  given.read(is, multiplier);
  if (given != rowDimensions(row) || mag(multiplier - 1) > SMALL)
  {
    char unit[64];
    FatalIOErrorInFunction(dict)
        << "entry '" << row.name << "' has dimensions " << given << " where "
        << rowDimensions(row) << " (" << part_param_unit_text(row.dims, sizeof unit, unit)
        << ") are needed" << exit(FatalIOError);
  }
}

static void readRow
(
  const dictionary& dict, const part_param_table& table, const part_param& row, void* values
)
{
  ITstream& is = dict.lookup(row.name);
  double numbers[3] = {0, 0, 0};
  string text;
  switch (row.type)
  {
    case PART_PARAM_SCALAR:
    {
      readDimensions(dict, row, is);
      numbers[0] = readScalar(is);
      break;
    }
    case PART_PARAM_VECTOR:
    {
      readDimensions(dict, row, is);
      const vector v(is);
      for (direction d = 0; d < 3; ++d) numbers[d] = v[d];
      break;
    }
    case PART_PARAM_INT:
    {
      numbers[0] = readScalar(is); // whole numbers up to 2^53, beyond label
      break;
    }
    case PART_PARAM_BOOL:
    {
      numbers[0] = Switch(is) ? 1 : 0;
      break;
    }
    default:
    {
      const token t(is);
      text = t.isWord() ? string(t.wordToken()) : t.isString() ? t.stringToken() : string();
      if (text.empty())
      {
        FatalIOErrorInFunction(dict)
            << "entry '" << row.name << "' needs a word, not " << t.info() << exit(FatalIOError);
      }
    }
  }
  if (is.nRemainingTokens())
  {
    FatalIOErrorInFunction(dict)
        << "entry '" << row.name << "' has more than one value" << exit(FatalIOError);
  }
  checkStatus(part_params_set(&table, row.name, numbers, text.c_str(), values), dict);
}

static wordList validNames(const part_param_table& table, const wordList& others)
{
  DynamicList<word> names(others);
  for (int i = 0; i < table.count; ++i) names.append(table.rows[i].name);
  return wordList(names);
}

void checkEntries(const dictionary& dict, const wordList& names)
{
  List<const char*> list(names.size());
  forAll(names, i) list[i] = names[i].c_str();
  for (const word& key : dict.toc())
  {
    if (key == "FoamFile" || names.found(key)) continue;
    const char* nearest = part_nearest_name(key.c_str(), names.size(), list.cdata());
    FatalIOErrorInFunction(dict)
        << "unknown entry '" << key << "'";
    if (nearest) FatalIOError << "; did you mean '" << nearest << "'?";
    FatalIOError << nl << "Entries allowed here: " << flatOutput(names) << exit(FatalIOError);
  }
}

void checkPositive(const dictionary& dict, const word& name, scalar value)
{
  if (value > 0) return;
  FatalIOErrorInFunction(dict)
      << "entry '" << name << "': " << value << " is not allowed; it must be > 0" << exit(FatalIOError);
}

void checkDimensions(const IOobject& field, const dimensionSet& given, const dimensionSet& needed)
{
  if (given == needed) return;
  FatalErrorInFunction
      << "file " << field.objectPath() << ": entry 'dimensions' is " << given << ", but " << field.name()
      << " needs " << needed << exit(FatalError);
}

void updateParams
(
  const dictionary& dict, const part_param_table& table, void* values, const wordList& others
)
{
  checkEntries(dict, validNames(table, others));
  for (int i = 0; i < table.count; ++i)
  {
    if (dict.found(table.rows[i].name)) readRow(dict, table, table.rows[i], values);
  }
  checkStatus(part_params_check(&table, values), dict);
}

void readParams
(
  const dictionary& dict, const part_param_table& table, void* values, const wordList& others
)
{
  part_params_default(&table, values);
  updateParams(dict, table, values, others);
}

} // namespace Foam

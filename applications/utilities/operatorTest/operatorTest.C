/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Run operatorSelfTest on the mesh of a case. */
#include "argList.H"
#include "fvMesh.H"
#include "operatorSelfTest.H"
#include "Time.H"

using namespace Foam;

int main(int argc, char *argv[]) {
  argList::addNote(
      "Check, on the mesh of this case, the OpenFOAM operators that the solvers call.\n"
      "One line per check: status, name, relative error, cells or faces checked/all, reason.\n"
      "Exit status 1 if one that must be exact is not.");
  argList::addOption("gradSchemes", "strings",
                     "also print the error of these gradient schemes for a linear field, "
                     "for example '(\"leastSquares\" \"Gauss pointLinear\")'");
  argList::noFunctionObjects();
#include "setRootCase.H"
#include "createTime.H"
#include "createNamedMesh.H"

  const bool good = operatorSelfTest(mesh, Info());
  if (args.found("gradSchemes")) {
    const List<string> schemes(args.get<List<string>>("gradSchemes"));
    for (const string &scheme : schemes) {
      Info << "gradient\t" << scheme.c_str() << token::TAB << linearGradientError(mesh, scheme)
           << endl;
    }
  }
  Info << (good ? "operatorTest: passed" : "operatorTest: FAILED") << endl;
  return good ? 0 : 1;
}

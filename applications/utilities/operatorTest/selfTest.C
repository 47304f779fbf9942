/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Compiled here, not linked from libfoamBridge, so that the test shows what this build does to the
 * operators. */
#include "operatorSelfTest.C"
#include "operatorSelfTestEquations.C"

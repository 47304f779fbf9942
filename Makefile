# SPDX-License-Identifier: GPL-3.0-or-later
#
# C libraries and their tests: a C compiler, MPI, parallel HDF5 and Zoltan; no OpenFOAM (that is ./Allwmake).
#
#   make                 build/lib/lib{particle,dem,coupling,sph}.{a,so}: those whose sources exist
#   make check           the same, then every tests/{particle,dem,coupling,sph}/test_*.c
#   make layers          fail on an #include that points the wrong way (tests/layers.sh)
#   make bench           the programs of tests/benchmark/*.c, into build/tests/benchmark
#   make install PREFIX=/usr/local    libraries, headers, pkg-config files (PREFIX/lib/pkgconfig/lib{particle,dem,...}.pc)
#   make clean
#
#   CHECK="--only dem"   passes options to tests/run (tests/run --help)
#   CC=clang  WERROR=1  NATIVE=1  SAN=address,undefined  OPT=-O2  CFLAGS=...  LDFLAGS=...  V=1
#
# Each variant (compiler, sanitizers, NATIVE) has a folder of its own: build/, build/clang/, build/gcc-address-undefined/ ...;
# O=folder sets another.

MAKEFLAGS += --no-builtin-rules
.SUFFIXES:
.SECONDARY:
.DELETE_ON_ERROR:
.DEFAULT_GOAL := all

ifeq ($(origin CC),default)
  CC := gcc
endif
AR      ?= ar
PREFIX  ?= /usr/local
DESTDIR ?=
OPT     ?= -O3
V       ?= 0
WERROR  ?= 0
NATIVE  ?= 0
SAN     ?=
comma   := ,

# ------------------------------------------------------------------------------------------- where

variant := $(notdir $(firstword $(CC)))$(if $(SAN),-$(subst $(comma),-,$(SAN)))$(if $(filter 1,$(NATIVE)),-native)
O       := build$(if $(filter-out gcc cc,$(variant)),/$(variant))

# In the order of dependence: each library may use those before it that deps_ names.
deps_particle :=
deps_dem      := particle
deps_coupling := particle
deps_sph      := particle
known := particle dem coupling sph
libs  := $(foreach l,$(known),$(if $(wildcard lib$(l)/src/*.c lib$(l)/src/*/*.c),$(l)))

# ------------------------------------------------------------------------------------------- flags

# Headers of others are system headers: only our own warnings count.
system = $(patsubst -I%,-isystem %,$(1))

ifeq ($(filter clean help,$(MAKECMDGOALS)),)
  MPI_CFLAGS    ?= $(shell pkg-config --cflags ompi-c 2>/dev/null || mpicc -showme:compile 2>/dev/null)
  MPI_LIBS      ?= $(shell pkg-config --libs ompi-c 2>/dev/null || mpicc -showme:link 2>/dev/null)
  HDF5_CFLAGS   ?= $(shell pkg-config --cflags hdf5-openmpi 2>/dev/null || pkg-config --cflags hdf5)
  HDF5_LIBS     ?= $(shell pkg-config --libs hdf5-openmpi 2>/dev/null || pkg-config --libs hdf5)
  CMOCKA_CFLAGS ?= $(shell pkg-config --cflags cmocka 2>/dev/null)
  CMOCKA_LIBS   ?= $(shell pkg-config --libs cmocka 2>/dev/null || echo -lcmocka)
endif
ZOLTAN_CFLAGS ?= -I/usr/include/trilinos
ZOLTAN_LIBS   ?= -ltrilinos_zoltan

warn := -Wall -Wextra -Wpedantic -Wshadow -Wconversion $(if $(filter 1,$(WERROR)),-Werror)
tune := $(OPT) -g $(if $(filter 1,$(NATIVE)),-march=native)
san  := $(if $(SAN),-fsanitize=$(SAN) -fno-omit-frame-pointer -fno-sanitize-recover=all)

CPPFLAGS_ALL := $(foreach l,$(known),-Ilib$(l)/include) \
                $(call system,$(sort $(MPI_CFLAGS) $(HDF5_CFLAGS) $(ZOLTAN_CFLAGS))) $(CPPFLAGS)
CFLAGS_ALL   := -std=c11 -fPIC $(warn) $(tune) $(san) $(CFLAGS)
LDFLAGS_ALL  := $(san) $(LDFLAGS)
LIBS_ALL     := $(ZOLTAN_LIBS) $(HDF5_LIBS) $(MPI_LIBS) -lm

ifeq ($(V),1)
  Q :=
  say = @:
else
  Q := @
  say = @printf '  %-5s %s\n' '$(1)' '$(2)'
endif

# Whatever decides the code is kept in a file; it changes only when its content does, and objects depend on it.
flags_text := $(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) $(LDFLAGS_ALL) $(LIBS_ALL) $(CMOCKA_CFLAGS) $(CMOCKA_LIBS)
$(O)/flags: force
	@mkdir -p $(@D)
	@echo '$(flags_text)' | cmp -s - $@ || echo '$(flags_text)' > $@

# ------------------------------------------------------------------------------------------- libraries

src_of = $(wildcard lib$(1)/src/*.c lib$(1)/src/*/*.c)
obj_of = $(patsubst %.c,$(O)/obj/%.o,$(call src_of,$(1)))

all: $(foreach l,$(libs),$(O)/lib/lib$(l).a $(O)/lib/lib$(l).so)

# What does not compile any more must not leave an old library or program to be tested: the failure of a library's
# file removes the library, that of a test its program, that of a test helper all test programs.
stale = $(if $(filter lib%,$(1)),$(addprefix $(O)/lib/$(firstword $(subst /, ,$(1))),.a .so),$\
        $(if $(filter $(1).c,$(test_src) $(bench_src)),$(O)/$(1),$(test_bin)))

$(O)/obj/%.o: %.c $(O)/flags
	@mkdir -p $(@D)
	$(call say,cc,$<)
	$(Q)$(CC) $(CPPFLAGS_ALL) $(CFLAGS_ALL) -MMD -MP -c $< -o $@ || { rm -f $@ $(call stale,$*); exit 1; }

# The name list makes the library again when a source file appears or goes away.
define library
$(O)/obj/lib$(1).list: force
	@mkdir -p $$(@D)
	@echo '$(call obj_of,$(1))' | cmp -s - $$@ || echo '$(call obj_of,$(1))' > $$@
$(O)/lib/lib$(1).a: $(call obj_of,$(1)) $(O)/obj/lib$(1).list
	@mkdir -p $$(@D)
	$$(call say,ar,$$@)
	$(Q)rm -f $$@ && $(AR) rcs $$@ $(call obj_of,$(1))
$(O)/lib/lib$(1).so: $(call obj_of,$(1)) $(O)/obj/lib$(1).list \
                     $(foreach d,$(filter $(libs),$(deps_$(1))),$(O)/lib/lib$(d).so)
	@mkdir -p $$(@D)
	$$(call say,ld,$$@)
	$(Q)$(CC) -shared $(if $(SAN),,-Wl$(comma)--no-undefined) -Wl,-soname,lib$(1).so -Wl,--disable-new-dtags,-rpath,'$$$$ORIGIN' \
	    $(call obj_of,$(1)) -L$(O)/lib $(foreach d,$(filter $(libs),$(deps_$(1))),-l$(d)) \
	    $(LDFLAGS_ALL) $(LIBS_ALL) -o $$@ || { rm -f $$@; exit 1; }
endef
$(foreach l,$(libs),$(eval $(call library,$(l))))

# ------------------------------------------------------------------------------------------- tests

# tests/<lib>/test_*.c       one program each
# tests/<lib>/<other>.c      helpers, linked to every test of that folder
# tests/naive/*.c            plain reference implementations, linked to every test and benchmark
# Tests include "naive/....h" and the helpers of their folder. They link to the shared library of their folder and to
# those that it depends on; benchmarks link to all.
folders   := $(addprefix tests/,$(known))
test_src  := $(wildcard $(addsuffix /test_*.c,$(folders)))
test_bin  := $(patsubst %.c,$(O)/%,$(test_src))
naive_obj := $(patsubst %.c,$(O)/obj/%.o,$(wildcard tests/naive/*.c))
bench_src := $(wildcard tests/benchmark/*.c)
bench_bin := $(patsubst %.c,$(O)/%,$(bench_src))
help_of    = $(patsubst %.c,$(O)/obj/%.o,$(filter-out $(1)/test_%,$(wildcard $(1)/*.c)))
# The test's own path wins over LD_LIBRARY_PATH, so a variant never picks up the libraries of another.
rpath     := -Wl,--disable-new-dtags,-rpath,$(abspath $(O))/lib
needs      = $(filter $(libs),$(1) $(deps_$(1)))

$(O)/obj/tests/%.o: CPPFLAGS_ALL += -Itests $(call system,$(CMOCKA_CFLAGS))

# Leak reports need the plug-ins of Open MPI to stay loaded, so that they can be recognised (etc/lsan.supp).
ifneq ($(SAN),)
  naive_obj += $(O)/obj/tests/sanitize/keepPlugins.o
endif

define program
$(O)/$(1): $(O)/obj/$(1).o $(2) $(naive_obj) $(foreach l,$(4),$(O)/lib/lib$(l).so)
	@mkdir -p $$(@D)
	$$(call say,ld,$$@)
	$(Q)$(CC) $(O)/obj/$(1).o $(2) $(naive_obj) -L$(O)/lib $(rpath) -Wl,--no-as-needed $(foreach l,$(4),-l$(l)) \
	    -Wl,--as-needed $(LDFLAGS_ALL) $(3) $(LIBS_ALL) -o $$@ || { rm -f $$@; exit 1; }
endef
folder = $(patsubst %/,%,$(dir $(1)))
$(foreach t,$(test_src),$(eval $(call program,$(t:.c=),$(call help_of,$(call folder,$(t))),$\
  $(CMOCKA_LIBS),$(call needs,$(notdir $(call folder,$(t)))))))
$(foreach t,$(bench_src),$(eval $(call program,$(t:.c=),,,$(libs))))

tests: $(test_bin)

# One file that does not compile must not hide the results of the others: tests/run counts what is missing as failed.
check:
ifeq ($(test_src),)
	@echo 'make check: there are no tests/{particle,dem,coupling,sph}/test_*.c yet'
else
	@$(MAKE) --no-print-directory -k all tests; built=$$?; \
	  tests/run --build $(O) $(CHECK) $(test_src) && exit $$built
endif

bench: all $(bench_bin)

layers:
	@tests/layers.sh

# ------------------------------------------------------------------------------------------- install, clean

# A pkg-config file for each library: its headers need MPI's, its static form also what the shared one is linked with.
VERSION := 0.1
about_particle := storage, neighbours, domain decomposition and files of particles
about_dem      := discrete elements: contact, walls, rigid bodies, integration
about_coupling := void fraction, drag and momentum exchange between particles and cells
about_sph      := smoothed particle hydrodynamics

define pc_text
prefix=$(PREFIX)
libdir=$${prefix}/lib
includedir=$${prefix}/include

Name: lib$(1)
Description: $(about_$(1))
Version: $(VERSION)
Requires:$(patsubst %, lib%,$(deps_$(1)))
Cflags: -I$${includedir} $(strip $(MPI_CFLAGS))
Libs: -L$${libdir} -l$(1) $(strip $(MPI_LIBS))
Libs.private: $(strip $(LIBS_ALL))
endef

install: all
	@mkdir -p $(DESTDIR)$(PREFIX)/include $(DESTDIR)$(PREFIX)/lib/pkgconfig
	$(foreach l,$(libs),cp -R lib$(l)/include/. $(DESTDIR)$(PREFIX)/include/ &&) true
	$(foreach l,$(libs),cp $(O)/lib/lib$(l).a $(O)/lib/lib$(l).so $(DESTDIR)$(PREFIX)/lib/ &&) true
	$(foreach l,$(libs),$(file >$(O)/lib$(l).pc,$(call pc_text,$(l)))cp $(O)/lib$(l).pc $(DESTDIR)$(PREFIX)/lib/pkgconfig/ &&) true

clean:
	rm -rf build

help:
	@sed -n '3,17s/^# \{0,1\}//p' Makefile

force:

.PHONY: all tests check bench layers install clean help force

-include $(shell find $(O)/obj -name '*.d' 2>/dev/null)

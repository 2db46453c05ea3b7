!> The module that `.pf` tests use, with the names of pFUnit.
module funit
  use pf_assert_equal, only: assertEqual
  use pf_assert_true, only: assertFalse, assertGreaterThan, assertGreaterThanOrEqual, &
                            assertLessThan, assertLessThanOrEqual, assertTrue
  use pf_context, only: anyExceptions, SourceLocation
  implicit none
  private
  public :: anyExceptions, SourceLocation
  public :: assertEqual, assertFalse, assertGreaterThan, assertGreaterThanOrEqual
  public :: assertLessThan, assertLessThanOrEqual, assertTrue
end module funit

// SPDX-License-Identifier: BSD-3-Clause
class Many {
 public:
  Many();
  ~Many();
  void f0();
  void f1();
  void f2();
  void f3();
  void f4();
  void f5();
  void f6();
  void f7();
  void f8();
  void f9();
  void f10();
  void f11();
  void f12();
  void f13();
  void f14();
  void f15();
  void f16();
  void f17();
  void f18();
  void f19();
  void f20();
  void f21();
  void f22();
  void f23();
  void f24();
  void f25();

 private:
  void hidden();
};

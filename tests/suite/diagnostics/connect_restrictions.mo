// status: 1
// error[MO0228] 54:18
// error[MO0228] 55:18
// error[MO0246] 57:5
// error[MO0230] 59:5
// error[MO0230] 60:5
package Restrictions
  connector Input = input Real;
  connector Output = output Real;
  connector Pin
    Real v;
    flow Real i;
  end Pin;
  connector Plug
    parameter Integer phases = 3;
    constant Real frequency = 50;
    Real v;
    flow Real i;
  end Plug;
  connector Socket
    Integer phases;
    constant Real frequency = 50;
    Real v;
    flow Real i;
  end Socket;
  connector Signal
    Real e;
    flow Real f;
    input Real u;
  end Signal;

  model Source
    Output y = 1;
  end Source;
  model Sink
    Input u;
  end Sink;
  model Outlet
    Plug plug(v = 1);
  end Outlet;
  model Device
    Plug plug(frequency = 60);
  end Device;
  model Adapter
    Socket socket(phases = 3);
  end Adapter;

  model System
    Source source, other;
    Sink sink;
    Outlet outlet;
    Device device;
    Adapter adapter;
    constant Pin pin;
    input Signal signal(e = 1, u = 2);
  equation
    connect(source.y, sink.u);
    connect(sink.u, other.y);
    connect(outlet.plug, device.plug);
    connect(outlet.plug, adapter.socket);
  end System;
end Restrictions;

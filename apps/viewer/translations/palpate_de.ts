<?xml version="1.0" encoding="utf-8"?>
<!DOCTYPE TS>
<TS version="2.1" language="de">
<context>
    <name>FileDialogs</name>
    <message>
        <source>Open raw data</source>
        <translation>Rohdaten öffnen</translation>
    </message>
    <message>
        <source>All files (*)</source>
        <translation>Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Open a volume, a session, layers or a recording</source>
        <translation>Volumen, Sitzung, Schichten oder Aufzeichnung öffnen</translation>
    </message>
    <message>
        <source>Open a folder of slices, or a Zarr image</source>
        <translation>Ordner mit Schichten oder Zarr-Bild öffnen</translation>
    </message>
    <message>
        <source>All that can be opened (%1 *.raw *.raw.gz *.json *.csv);;All files (*)</source>
        <translation>Alles, was sich öffnen lässt (%1 *.raw *.raw.gz *.json *.csv);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Open an overlay: labels or another image</source>
        <translation>Überlagerung öffnen: Labels oder ein anderes Bild</translation>
    </message>
    <message>
        <source>Volumes (%1);;All files (*)</source>
        <translation>Volumen (%1);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>%1 exists already. Replace it?</source>
        <translation>%1 gibt es schon. Ersetzen?</translation>
    </message>
</context>
<context>
    <name>ForceRows</name>
    <message>
        <source>Stiffness</source>
        <translation>Steifigkeit</translation>
    </message>
    <message>
        <source>Stiffness k of the spring between hand and proxy [N/mm].
The slider ends where device and loop can no longer render it stably.</source>
        <translation>Steifigkeit k der Feder zwischen Hand und Proxy [N/mm].
Der Schieber endet, wo Gerät und Regelkreis sie nicht mehr stabil wiedergeben können.</translation>
    </message>
    <message>
        <source>Damping</source>
        <translation>Dämpfung</translation>
    </message>
    <message>
        <source>Against the hand&apos;s motion along the contact normal [N s/mm]; never pulls the hand in</source>
        <translation>Gegen die Bewegung der Hand entlang der Kontaktnormalen [N s/mm]; zieht die Hand nie hinein</translation>
    </message>
    <message>
        <source>Viscosity</source>
        <translation>Viskosität</translation>
    </message>
    <message>
        <source>Of the medium, against all motion, in contact or not [N s/mm]</source>
        <translation>Des Mediums, gegen jede Bewegung, mit oder ohne Kontakt [N s/mm]</translation>
    </message>
    <message>
        <source>Static friction</source>
        <translation>Haftreibung</translation>
    </message>
    <message>
        <source>Coefficient past which the proxy begins to slide (no unit)</source>
        <translation>Koeffizient, ab dem der Proxy zu gleiten beginnt (ohne Einheit)</translation>
    </message>
    <message>
        <source>Dynamic friction</source>
        <translation>Gleitreibung</translation>
    </message>
    <message>
        <source>Coefficient while the proxy slides, at most the static one (no unit)</source>
        <translation>Koeffizient, solange der Proxy gleitet, höchstens der der Haftreibung (ohne Einheit)</translation>
    </message>
    <message>
        <source>Texture height</source>
        <translation>Texturhöhe</translation>
    </message>
    <message>
        <source>Height of the bumps in the volume; 0: smooth</source>
        <translation>Höhe der Unebenheiten im Volumen; 0: glatt</translation>
    </message>
    <message>
        <source>Texture length</source>
        <translation>Texturlänge</translation>
    </message>
    <message>
        <source>From bump to bump in the volume</source>
        <translation>Von Unebenheit zu Unebenheit im Volumen</translation>
    </message>
    <message>
        <source>Magnet reach</source>
        <translation>Magnetweite</translation>
    </message>
    <message>
        <source>From how far a free hand is pulled to the surface [mm of the hand]; 0: off</source>
        <translation>Aus welcher Entfernung eine freie Hand zur Oberfläche gezogen wird [mm der Hand]; 0: aus</translation>
    </message>
    <message>
        <source>Magnet force</source>
        <translation>Magnetkraft</translation>
    </message>
    <message>
        <source>Greatest pull of the magnet, half-way to the surface [N]</source>
        <translation>Größter Zug des Magneten, auf halbem Weg zur Oberfläche [N]</translation>
    </message>
    <message>
        <source>Force limit</source>
        <translation>Kraftgrenze</translation>
    </message>
    <message>
        <source>Greatest force asked of the device [N]; the device&apos;s own limit holds as well</source>
        <translation>Größte Kraft, die vom Gerät verlangt wird [N]; die Grenze des Geräts selbst gilt auch</translation>
    </message>
    <message>
        <source>Force rate</source>
        <translation>Kraftänderung</translation>
    </message>
    <message>
        <source>Greatest change of the force [N/s]; a stop may drop it at once</source>
        <translation>Größte Änderung der Kraft [N/s]; ein Halt darf sie sofort auf null bringen</translation>
    </message>
    <message>
        <source>Force ramp</source>
        <translation>Anstieg</translation>
    </message>
    <message>
        <source>How long the force rises at the start and after a pause [s]</source>
        <translation>Wie lange die Kraft am Anfang und nach einer Pause ansteigt [s]</translation>
    </message>
    <message>
        <source>Starts below</source>
        <translation>Beginnt unter</translation>
    </message>
    <message>
        <source>After a start or a pause there is no force until the computed one is this small [N]; inf: it begins at any</source>
        <translation>Nach einem Start oder einer Pause gibt es keine Kraft, bis die berechnete so klein ist [N]; inf: sie beginnt bei jeder</translation>
    </message>
    <message>
        <source>Stale after</source>
        <translation>Veraltet nach</translation>
    </message>
    <message>
        <source>Longest time from one reading of the device to the next [s]; a longer one is a pause without force</source>
        <translation>Längste Zeit von einer Ablesung des Geräts zur nächsten [s]; eine längere ist eine Pause ohne Kraft</translation>
    </message>
    <message>
        <source>Turning stiffness</source>
        <translation>Drehsteifigkeit</translation>
    </message>
    <message>
        <source>Stiffness against turning a tool [N mm/rad]; 0: from the stiffness and the tool&apos;s size</source>
        <translation>Steifigkeit gegen das Drehen eines Werkzeugs [N mm/rad]; 0: aus der Steifigkeit und der Größe des Werkzeugs</translation>
    </message>
    <message>
        <source>Turning damping</source>
        <translation>Drehdämpfung</translation>
    </message>
    <message>
        <source>Against the turning of a tool [N mm s/rad]; never turns the hand further</source>
        <translation>Gegen das Drehen eines Werkzeugs [N mm s/rad]; dreht die Hand nie weiter</translation>
    </message>
    <message>
        <source>Torque limit</source>
        <translation>Drehmomentgrenze</translation>
    </message>
    <message>
        <source>Greatest torque asked of the device [N mm]; the device&apos;s own limit holds as well</source>
        <translation>Größtes Drehmoment, das vom Gerät verlangt wird [N mm]; die Grenze des Geräts selbst gilt auch</translation>
    </message>
    <message>
        <source>Torque rate</source>
        <translation>Drehmomentänderung</translation>
    </message>
    <message>
        <source>Greatest change of the torque [N mm/s]; a stop may drop it at once</source>
        <translation>Größte Änderung des Drehmoments [N mm/s]; ein Halt darf es sofort auf null bringen</translation>
    </message>
</context>
<context>
    <name>Help</name>
    <message>
        <source>Mouse in the scene</source>
        <translation>Maus in der Szene</translation>
    </message>
    <message>
        <source>Left click</source>
        <translation>Linksklick</translation>
    </message>
    <message>
        <source>with the mouse as device: touch the surface; held: press deeper</source>
        <translation>mit der Maus als Gerät: Oberfläche berühren; gehalten: tiefer drücken</translation>
    </message>
    <message>
        <source>Left drag</source>
        <translation>Ziehen links</translation>
    </message>
    <message>
        <source>turn; with the mouse as device: move the probe in the plane of the view</source>
        <translation>drehen; mit der Maus als Gerät: Sonde in der Bildebene bewegen</translation>
    </message>
    <message>
        <source>Wheel</source>
        <translation>Rad</translation>
    </message>
    <message>
        <source>zoom; with the mouse as device: probe into the depth (Shift: finely; Ctrl: zoom)</source>
        <translation>zoomen; mit der Maus als Gerät: Sonde in die Tiefe (Umschalt: fein; Strg: zoomen)</translation>
    </message>
    <message>
        <source>Right drag</source>
        <translation>Ziehen rechts</translation>
    </message>
    <message>
        <source>zoom; with the mouse as device: turn (Shift or middle: pan)</source>
        <translation>zoomen; mit der Maus als Gerät: drehen (Umschalt oder mittlere Taste: verschieben)</translation>
    </message>
    <message>
        <source>Double click</source>
        <translation>Doppelklick</translation>
    </message>
    <message>
        <source>this pane alone, or again all</source>
        <translation>nur dieses Feld, oder wieder alle</translation>
    </message>
    <message>
        <source>Shift and double click</source>
        <translation>Umschalt und Doppelklick</translation>
    </message>
    <message>
        <source>centre there</source>
        <translation>dorthin zentrieren</translation>
    </message>
    <message>
        <source>Mouse in a slice</source>
        <translation>Maus in einem Schnitt</translation>
    </message>
    <message>
        <source>Left</source>
        <translation>Links</translation>
    </message>
    <message>
        <source>crosshair (Ctrl: the probe, with the mouse as device)</source>
        <translation>Fadenkreuz (Strg: die Sonde, mit der Maus als Gerät)</translation>
    </message>
    <message>
        <source>next slice (Ctrl: zoom)</source>
        <translation>nächster Schnitt (Strg: zoomen)</translation>
    </message>
    <message>
        <source>window and level</source>
        <translation>Fensterbreite und Fensterlage</translation>
    </message>
    <message>
        <source>Middle drag</source>
        <translation>Ziehen mit mittlerer Taste</translation>
    </message>
    <message>
        <source>pan; Shift and double click: the whole slice</source>
        <translation>verschieben; Umschalt und Doppelklick: der ganze Schnitt</translation>
    </message>
    <message>
        <source>First steps</source>
        <translation>Erste Schritte</translation>
    </message>
    <message>
        <source>&lt;h3&gt;Touch&lt;/h3&gt;&lt;p&gt;Click a surface: the probe goes there and touches it. Hold the button, or turn the wheel, to press; drag to move along the surface. The blue ball is your hand, the vermilion one the proxy, which stays on the surface; the green arrow is the force. The right button turns the view. With a haptic device, choose it under &lt;i&gt;Device&lt;/i&gt;.&lt;/p&gt;&lt;h3&gt;Choose what is solid&lt;/h3&gt;&lt;p&gt;Drag the line in the histogram: everything denser is solid, at once. The ticks are good levels to begin with.&lt;/p&gt;&lt;h3&gt;Go deeper&lt;/h3&gt;&lt;p&gt;Under &lt;i&gt;Pressing through&lt;/i&gt; switch on &lt;i&gt;Surfaces give way&lt;/i&gt;: press harder, and the hand goes through to what is denser.&lt;/p&gt;&lt;h3&gt;See more&lt;/h3&gt;&lt;p&gt;Under &lt;i&gt;Look&lt;/i&gt; add a surface: skin over bone. V cuts everything open with a plane; drag its blue balls. M measures a length. Under &lt;i&gt;Data&lt;/i&gt; open an overlay: labels or another image.&lt;/p&gt;&lt;h3&gt;Change the data&lt;/h3&gt;&lt;p&gt;Switch the brush on (B) and touch: it carves, adds, smooths or paints. Ctrl+Z takes a stroke back, Ctrl+Shift+S saves the volume.&lt;/p&gt;&lt;h3&gt;Come back&lt;/h3&gt;&lt;p&gt;Ctrl+S saves the session: volume, level, view and settings. Ctrl+R records what is felt, to be played later.&lt;/p&gt;</source>
        <translation>&lt;h3&gt;Berühren&lt;/h3&gt;&lt;p&gt;Klicken Sie auf eine Oberfläche: Die Sonde geht dorthin und berührt sie. Halten Sie die Taste gedrückt oder drehen Sie das Rad, um zu drücken; ziehen Sie, um an der Oberfläche entlangzufahren. Die blaue Kugel ist Ihre Hand, die zinnoberrote der Proxy, der auf der Oberfläche bleibt; der grüne Pfeil ist die Kraft. Die rechte Taste dreht die Ansicht. Ein haptisches Gerät wählen Sie unter &lt;i&gt;Gerät&lt;/i&gt;.&lt;/p&gt;&lt;h3&gt;Wählen, was fest ist&lt;/h3&gt;&lt;p&gt;Ziehen Sie die Linie im Histogramm: Alles, was dichter ist, ist sofort fest. Die Striche sind gute Werte für den Anfang.&lt;/p&gt;&lt;h3&gt;Tiefer gehen&lt;/h3&gt;&lt;p&gt;Schalten Sie unter &lt;i&gt;Durchdrücken&lt;/i&gt; &lt;i&gt;Oberflächen geben nach&lt;/i&gt; ein: Drücken Sie stärker, und die Hand geht hindurch zu dem, was dichter ist.&lt;/p&gt;&lt;h3&gt;Mehr sehen&lt;/h3&gt;&lt;p&gt;Fügen Sie unter &lt;i&gt;Aussehen&lt;/i&gt; eine Fläche hinzu: Haut über Knochen. V schneidet alles mit einer Ebene auf; ziehen Sie an ihren blauen Kugeln. M misst eine Länge. Öffnen Sie unter &lt;i&gt;Daten&lt;/i&gt; eine Überlagerung: Labels oder ein anderes Bild.&lt;/p&gt;&lt;h3&gt;Daten ändern&lt;/h3&gt;&lt;p&gt;Schalten Sie den Pinsel ein (B) und berühren Sie: Er trägt ab, trägt auf, glättet oder malt. Strg+Z nimmt einen Strich zurück, Strg+Umschalt+S speichert das Volumen.&lt;/p&gt;&lt;h3&gt;Wiederkommen&lt;/h3&gt;&lt;p&gt;Strg+S speichert die Sitzung: Volumen, Isowert, Ansicht und Einstellungen. Strg+R zeichnet auf, was gefühlt wird, um es später abzuspielen.&lt;/p&gt;</translation>
    </message>
    <message>
        <source>Keys</source>
        <translation>Tasten</translation>
    </message>
    <message>
        <source>Shortcuts</source>
        <translation>Tastenkürzel</translation>
    </message>
    <message>
        <source>Palpate %1, Qt %2, VTK %3, built %4</source>
        <translation>Palpate %1, Qt %2, VTK %3, gebaut %4</translation>
    </message>
    <message>
        <source>for 64 bits</source>
        <translation>für 64 Bit</translation>
    </message>
    <message>
        <source>for 32 bits</source>
        <translation>für 32 Bit</translation>
    </message>
    <message>
        <source>About Palpate</source>
        <translation>Über Palpate</translation>
    </message>
    <message>
        <source>&lt;h2&gt;Palpate&lt;/h2&gt;&lt;p&gt;Feel the surfaces inside volumetric data.&lt;/p&gt;&lt;p&gt;%1&lt;/p&gt;&lt;p&gt;After &quot;Volume Haptic Rendering with Dynamically Extracted Isosurface&quot; by Corenthy, San Martin, Otaduy and Garcia (2012).&lt;/p&gt;&lt;p&gt;Not a medical device: for research, teaching and development.&lt;/p&gt;</source>
        <translation>&lt;h2&gt;Palpate&lt;/h2&gt;&lt;p&gt;Die Oberflächen in Volumendaten fühlen.&lt;/p&gt;&lt;p&gt;%1&lt;/p&gt;&lt;p&gt;Nach „Volume Haptic Rendering with Dynamically Extracted Isosurface“ von Corenthy, San Martin, Otaduy und Garcia (2012).&lt;/p&gt;&lt;p&gt;Kein Medizinprodukt: für Forschung, Lehre und Entwicklung.&lt;/p&gt;</translation>
    </message>
</context>
<context>
    <name>Names</name>
    <message>
        <source>CT bone</source>
        <translation>CT Knochen</translation>
    </message>
    <message>
        <source>CT skin</source>
        <translation>CT Haut</translation>
    </message>
    <message>
        <source>CT soft tissue</source>
        <translation>CT Weichteile</translation>
    </message>
    <message>
        <source>MR</source>
        <translation>MRT</translation>
    </message>
    <message>
        <source>Microscopy</source>
        <translation>Mikroskopie</translation>
    </message>
    <message>
        <source>Grey</source>
        <translation>Grau</translation>
    </message>
    <message>
        <source>grey</source>
        <translation>Grau</translation>
    </message>
    <message>
        <source>hot</source>
        <translation>Glut</translation>
    </message>
    <message>
        <source>bone</source>
        <translation>Knochen</translation>
    </message>
    <message>
        <source>viridis</source>
        <translation>Viridis</translation>
    </message>
    <message>
        <source>cool-warm</source>
        <translation>Kalt–Warm</translation>
    </message>
    <message>
        <source>spectrum</source>
        <translation>Spektrum</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <source>the machine</source>
        <translation>der Rechner</translation>
    </message>
    <message>
        <source>the device</source>
        <translation>das Gerät</translation>
    </message>
    <message>
        <source>the proxy update</source>
        <translation>der Proxy</translation>
    </message>
    <message>
        <source>the rest of the tick</source>
        <translation>der Rest des Takts</translation>
    </message>
    <message>
        <source>unknown</source>
        <translation>unbekannt</translation>
    </message>
    <message>
        <source>on %1</source>
        <translation>auf %1</translation>
    </message>
    <message>
        <source>in %1</source>
        <translation>in %1</translation>
    </message>
    <message>
        <source>on %1, in %2</source>
        <translation>auf %1, in %2</translation>
    </message>
    <message>
        <source>Own layers</source>
        <translation>Eigene Schichten</translation>
    </message>
    <message>
        <source>Labels of %1</source>
        <translation>Labels von %1</translation>
    </message>
    <message>
        <source>%1, by label</source>
        <translation>%1, nach Labels</translation>
    </message>
    <message>
        <source>on %1, from inside</source>
        <translation>auf %1, von innen</translation>
    </message>
    <message>
        <source>Dense parts</source>
        <translation>Dichte Teile</translation>
    </message>
    <message>
        <source>Outer surface</source>
        <translation>Äußere Oberfläche</translation>
    </message>
    <message>
        <source>Soft parts</source>
        <translation>Weiche Teile</translation>
    </message>
</context>
<context>
    <name>OverlayWords</name>
    <message>
        <source>overlay %1</source>
        <translation>Überlagerung %1</translation>
    </message>
</context>
<context>
    <name>Sentences</name>
    <message>
        <source>%1 = %2: must be %3</source>
        <translation>%1 = %2: erlaubt ist %3</translation>
    </message>
    <message>
        <source>the isovalue lies outside the data&apos;s range: nothing is solid, so there is nothing to touch</source>
        <translation>Der Isowert liegt außerhalb des Wertebereichs der Daten: Nichts ist fest, also gibt es nichts zu fühlen</translation>
    </message>
    <message>
        <source>the background outside the data is solid at this isovalue: all of space outside the data will be solid (choose another isovalue or background)</source>
        <translation>Der Hintergrund außerhalb der Daten ist bei diesem Isowert fest: Der ganze Raum außerhalb der Daten wird fest (anderen Isowert oder Hintergrund wählen)</translation>
    </message>
    <message>
        <source>%1: the data is constant, so there is no surface to touch</source>
        <translation>%1: Alle Werte sind gleich, also gibt es keine Fläche zu fühlen</translation>
    </message>
    <message>
        <source>%1 does not give its orientation, and %2 does: left and right of one of them may be mirrored (palpate convert %3 OUT --orientation RAS writes it with one)</source>
        <translation>%1 nennt seine Orientierung nicht, %2 nennt sie: Links und rechts können bei einem von beiden vertauscht sein (palpate convert %3 OUT --orientation RAS schreibt es mit Orientierung)</translation>
    </message>
    <message>
        <source>%1 does not give its spacing, and %2 does: they may differ in size (palpate convert %3 OUT --spacing X,Y,Z writes it with one)</source>
        <translation>%1 nennt seinen Abstand der Werte nicht, %2 nennt ihn: Sie können verschieden groß sein (palpate convert %3 OUT --spacing X,Y,Z schreibt es mit Abstand)</translation>
    </message>
    <message>
        <source>the layers are in %1; %2 does not say what its densities are in</source>
        <translation>Die Schichten sind in %1; %2 nennt die Einheit seiner Dichten nicht</translation>
    </message>
    <message>
        <source>the layers are in %1; %2 is in %3</source>
        <translation>Die Schichten sind in %1; %2 ist in %3</translation>
    </message>
    <message>
        <source>these layers lie outside the densities of %1: %2</source>
        <translation>Diese Schichten liegen außerhalb der Dichten von %1: %2</translation>
    </message>
    <message>
        <source>there is not enough memory for the surface</source>
        <translation>Für die Oberfläche reicht der Speicher nicht</translation>
    </message>
    <message>
        <source>the isovalue is not finite</source>
        <translation>Der Isowert ist nicht endlich</translation>
    </message>
    <message>
        <source>the isovalue is not a number, or infinite so that all of space is solid</source>
        <translation>Der Isowert ist keine Zahl oder so unendlich, dass der ganze Raum fest ist</translation>
    </message>
    <message>
        <source>the penetration threshold must be at least 0 mm, not %1</source>
        <translation>Die Schwelle zum Durchdrücken muss mindestens 0 mm sein, nicht %1</translation>
    </message>
    <message>
        <source>a range of interest needs low &lt;= high, not %1 to %2</source>
        <translation>Ein Bereich braucht unten &lt;= oben, nicht %1 bis %2</translation>
    </message>
    <message>
        <source>friction: needs 0 &lt;= dynamic coefficient &lt;= static coefficient</source>
        <translation>Reibung: nötig ist 0 &lt;= Gleitreibung &lt;= Haftreibung</translation>
    </message>
    <message>
        <source>tools need the cubic field: a linear one can be touched only with a point</source>
        <translation>Werkzeuge brauchen das kubische Feld: Ein lineares lässt sich nur mit einem Punkt fühlen</translation>
    </message>
    <message>
        <source>a tool cannot be combined with %1: use only one of the two</source>
        <translation>Ein Werkzeug geht nicht zusammen mit: %1. Nur eines von beiden verwenden</translation>
    </message>
    <message>
        <source>layers</source>
        <translation>Schichten</translation>
    </message>
    <message>
        <source>penetrability</source>
        <translation>Durchdrücken</translation>
    </message>
    <message>
        <source>a magnet</source>
        <translation>Magnet</translation>
    </message>
    <message>
        <source>a texture</source>
        <translation>Textur</translation>
    </message>
    <message>
        <source>layer &quot;%1&quot; is there twice</source>
        <translation>Die Schicht „%1“ gibt es zweimal</translation>
    </message>
    <message>
        <source>layer &quot;%1&quot;: its level must be finite</source>
        <translation>Schicht „%1“: Ihr Wert muss endlich sein</translation>
    </message>
    <message>
        <source>layer &quot;%1&quot;: levels must rise from layer to layer, from outside in</source>
        <translation>Schicht „%1“: Die Werte müssen von außen nach innen von Schicht zu Schicht steigen</translation>
    </message>
    <message>
        <source>layer &quot;%1&quot;: levels must fall from layer to layer, from outside in</source>
        <translation>Schicht „%1“: Die Werte müssen von außen nach innen von Schicht zu Schicht fallen</translation>
    </message>
    <message>
        <source>layer %1 has no name</source>
        <translation>Schicht %1 hat keinen Namen</translation>
    </message>
    <message>
        <source>real-time priority: SCHED_FIFO %1</source>
        <translation>Echtzeitpriorität: SCHED_FIFO %1</translation>
    </message>
    <message>
        <source>real-time priority: not granted (%1); allow it with a line &apos;@audio - rtprio 90&apos; in /etc/security/limits.d and your user in that group</source>
        <translation>Echtzeitpriorität: nicht gewährt (%1); zu erlauben mit einer Zeile &apos;@audio - rtprio 90&apos; in /etc/security/limits.d und dem Benutzer in dieser Gruppe</translation>
    </message>
    <message>
        <source>memory: locked</source>
        <translation>Speicher: gesperrt</translation>
    </message>
    <message>
        <source>a number</source>
        <translation>eine Zahl</translation>
    </message>
    <message>
        <source>finite</source>
        <translation>endlich</translation>
    </message>
    <message>
        <source>from %1 to %2</source>
        <translation>%1 bis %2</translation>
    </message>
    <message>
        <source>finite and at least %1</source>
        <translation>endlich und mindestens %1</translation>
    </message>
    <message>
        <source>finite and above 0</source>
        <translation>endlich und über 0</translation>
    </message>
    <message>
        <source>above 0 (inf: none)</source>
        <translation>über 0 (inf: keine)</translation>
    </message>
    <message>
        <source>at least 0 (inf: none)</source>
        <translation>mindestens 0 (inf: keine)</translation>
    </message>
    <message>
        <source>at least 0 (inf: start at any)</source>
        <translation>mindestens 0 (inf: Beginn bei jeder Kraft)</translation>
    </message>
    <message>
        <source>at most %1 at %2 Hz and a delay of %3 ms to be rendered stably</source>
        <translation>höchstens %1 bei %2 Hz und %3 ms Verzögerung, um stabil zu sein</translation>
    </message>
    <message>
        <source>at most %1 at %2 Hz to be rendered stably</source>
        <translation>höchstens %1 bei %2 Hz, um stabil zu sein</translation>
    </message>
    <message>
        <source>at most %1 over this distance</source>
        <translation>höchstens %1 bei dieser Reichweite</translation>
    </message>
    <message>
        <source>below the physical damping of device and hand, %1</source>
        <translation>weniger als die physische Dämpfung von Gerät und Hand, %1</translation>
    </message>
    <message>
        <source>below the physical rotational damping of device and hand, %1</source>
        <translation>weniger als die physische Drehdämpfung von Gerät und Hand, %1</translation>
    </message>
    <message>
        <source>stiffness [N/mm]</source>
        <translation>Steifigkeit [N/mm]</translation>
    </message>
    <message>
        <source>damping [N s/mm]</source>
        <translation>Dämpfung [N s/mm]</translation>
    </message>
    <message>
        <source>damping + viscosity [N s/mm]</source>
        <translation>Dämpfung + Viskosität [N s/mm]</translation>
    </message>
    <message>
        <source>viscosity [N s/mm]</source>
        <translation>Viskosität [N s/mm]</translation>
    </message>
    <message>
        <source>force limit [N]</source>
        <translation>Kraftgrenze [N]</translation>
    </message>
    <message>
        <source>force rate limit [N/s]</source>
        <translation>Grenze der Kraftänderung [N/s]</translation>
    </message>
    <message>
        <source>force ramp [s]</source>
        <translation>Kraftrampe [s]</translation>
    </message>
    <message>
        <source>force to start below [N]</source>
        <translation>Beginn unterhalb von [N]</translation>
    </message>
    <message>
        <source>stale time [s]</source>
        <translation>Zeit bis veraltet [s]</translation>
    </message>
    <message>
        <source>magnet peak [N]</source>
        <translation>Magnetkraft [N]</translation>
    </message>
    <message>
        <source>rotational stiffness [N mm/rad]</source>
        <translation>Drehsteifigkeit [N mm/rad]</translation>
    </message>
    <message>
        <source>rotational damping [N mm s/rad]</source>
        <translation>Drehdämpfung [N mm s/rad]</translation>
    </message>
    <message>
        <source>torque limit [N mm]</source>
        <translation>Drehmomentgrenze [N mm]</translation>
    </message>
    <message>
        <source>torque rate limit [N mm/s]</source>
        <translation>Grenze der Drehmomentänderung [N mm/s]</translation>
    </message>
</context>
<context>
    <name>Streaming</name>
    <message>
        <source>single samples</source>
        <translation>einzelne Abtastwerte</translation>
    </message>
    <message>
        <source>felt: level %1, seen: level %2</source>
        <translation>gefühlt: Stufe %1, gesehen: Stufe %2</translation>
    </message>
    <message>
        <source>%1 of %2 bricks missing</source>
        <translation>%1 von %2 Blöcken fehlen</translation>
    </message>
    <message>
        <source>%1 of %2 tiles missing</source>
        <translation>%1 von %2 Kacheln fehlen</translation>
    </message>
    <message>
        <source>cannot be read now, tried again</source>
        <translation>jetzt nicht lesbar, wird wieder versucht</translation>
    </message>
    <message>
        <source>The hand: %1 bricks in memory (%2), %3 wanted, %4 missing, %5 at once</source>
        <translation>Die Hand: %1 Blöcke im Speicher (%2), %3 gebraucht, %4 fehlen, %5 davon eilig</translation>
    </message>
    <message>
        <source>Pictures: %1 tiles wanted, %2 missing, %3 coming, %4 failed; %5 in memory</source>
        <translation>Bilder: %1 Kacheln gebraucht, %2 fehlen, %3 kommen, %4 gescheitert; %5 im Speicher</translation>
    </message>
    <message>
        <source>Read: %1 by %2 requests, %3 tried again, %4 found in the disk cache</source>
        <translation>Gelesen: %1 in %2 Anfragen, %3 wiederholt, %4 im Zwischenspeicher gefunden</translation>
    </message>
    <message>
        <source>The whole is seen at level %1</source>
        <translation>Das Ganze ist auf Stufe %1 zu sehen</translation>
    </message>
    <message>
        <source>The hand waits: %1</source>
        <translation>Die Hand wartet: %1</translation>
    </message>
    <message numerus="yes">
        <source>The hand waits: %n brick(s) round it are being read</source>
        <translation>
            <numerusform>Die Hand wartet: %n Block um sie wird gelesen</numerusform>
            <numerusform>Die Hand wartet: %n Blöcke um sie werden gelesen</numerusform>
        </translation>
    </message>
</context>
<context>
    <name>TimelineWords</name>
    <message>
        <source>%1, live</source>
        <translation>%1, live</translation>
    </message>
    <message>
        <source>%1, frame %2 of %3</source>
        <translation>%1, Bild %2 von %3</translation>
    </message>
    <message>
        <source>force up to %1 N</source>
        <translation>Kraft bis %1 N</translation>
    </message>
    <message>
        <source>isovalue %1</source>
        <translation>Isowert %1</translation>
    </message>
    <message>
        <source>in contact</source>
        <translation>in Kontakt</translation>
    </message>
</context>
<context>
    <name>Units</name>
    <message>
        <source>voxel</source>
        <translation>Voxel</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::BackgroundTask</name>
    <message>
        <source>Cancel</source>
        <translation>Abbrechen</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::BrushControls</name>
    <message>
        <source>Carve</source>
        <translation>Abtragen</translation>
    </message>
    <message>
        <source>Takes solid away where the brush is</source>
        <translation>Nimmt Festes weg, wo der Pinsel ist</translation>
    </message>
    <message>
        <source>Add</source>
        <translation>Auftragen</translation>
    </message>
    <message>
        <source>Puts solid on where the brush is</source>
        <translation>Setzt Festes auf, wo der Pinsel ist</translation>
    </message>
    <message>
        <source>Smooth</source>
        <translation>Glätten</translation>
    </message>
    <message>
        <source>Blurs: edges and noise wear off</source>
        <translation>Weichzeichnen: Kanten und Rauschen nutzen sich ab</translation>
    </message>
    <message>
        <source>Paint</source>
        <translation>Malen</translation>
    </message>
    <message>
        <source>Brings the samples to the value, up or down</source>
        <translation>Bringt die Abtastwerte auf den Wert, aufwärts oder abwärts</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keiner</translation>
    </message>
    <message>
        <source>one step</source>
        <translation>ein Schritt</translation>
    </message>
    <message numerus="yes">
        <source>%n steps</source>
        <translation>
            <numerusform>%n Schritt</numerusform>
            <numerusform>%n Schritte</numerusform>
        </translation>
    </message>
    <message>
        <source>While it is on, the probe edits the samples where it is</source>
        <translation>Solange er eingeschaltet ist, ändert die Sonde die Abtastwerte, wo sie ist</translation>
    </message>
    <message>
        <source>At once</source>
        <translation>Sofort</translation>
    </message>
    <message>
        <source>Automatic</source>
        <translation>Automatisch</translation>
    </message>
    <message>
        <source>Save as...</source>
        <translation>Speichern …</translation>
    </message>
    <message>
        <source>Writes the volume as it is now to a file</source>
        <translation>Schreibt das Volumen, wie es jetzt ist, in eine Datei</translation>
    </message>
    <message>
        <source>Radius of the brush</source>
        <translation>Radius des Pinsels</translation>
    </message>
    <message>
        <source>Hardness of the brush</source>
        <translation>Härte des Pinsels</translation>
    </message>
    <message>
        <source>Rate of the brush</source>
        <translation>Rate des Pinsels</translation>
    </message>
    <message>
        <source>Value of the brush</source>
        <translation>Wert des Pinsels</translation>
    </message>
    <message>
        <source>Undo</source>
        <translation>Zurück</translation>
    </message>
    <message>
        <source>Radius</source>
        <translation>Radius</translation>
    </message>
    <message>
        <source>Hardness</source>
        <translation>Härte</translation>
    </message>
    <message>
        <source>1: an edge of two voxels; 0: an edge as wide as the brush</source>
        <translation>1: ein Rand von zwei Voxeln; 0: ein Rand so breit wie der Pinsel</translation>
    </message>
    <message>
        <source>Rate</source>
        <translation>Rate</translation>
    </message>
    <message>
        <source>How fast the samples approach their final value [1/s]: 63 % of it after 1/rate s</source>
        <translation>Wie schnell sich die Abtastwerte dem Endwert nähern [1/s]: 63 % davon nach 1/Rate s</translation>
    </message>
    <message>
        <source>Value</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>What a whole touch leaves [data units]. Automatic: what fits the level that is felt</source>
        <translation>Was eine ganze Berührung hinterlässt [Dateneinheiten]. Automatisch: was zum gefühlten Isowert passt</translation>
    </message>
    <message>
        <source>Kind of brush</source>
        <translation>Art des Pinsels</translation>
    </message>
    <message>
        <source>the brush&apos;s radius must be from %1 %4 (a voxel) to %2 %4 (a quarter of the grid), not %3 %4</source>
        <translation>der Radius des Pinsels muss von %1 %4 (einem Voxel) bis %2 %4 (einem Viertel des Gitters) sein, nicht %3 %4</translation>
    </message>
    <message>
        <source>the brush&apos;s hardness must be from %1 to %2, not %3</source>
        <translation>die Härte des Pinsels muss von %1 bis %2 sein, nicht %3</translation>
    </message>
    <message>
        <source>the brush&apos;s rate must be from %1 to %2 /s or at once, not %3 /s</source>
        <translation>die Rate des Pinsels muss von %1 bis %2 /s sein oder sofort, nicht %3 /s</translation>
    </message>
    <message>
        <source>Brush at the probe is ON</source>
        <translation>Pinsel an der Sonde ist AN</translation>
    </message>
    <message>
        <source>Brush at the probe is off</source>
        <translation>Pinsel an der Sonde ist aus</translation>
    </message>
    <message>
        <source>Takes the last edit back</source>
        <translation>Nimmt die letzte Änderung zurück</translation>
    </message>
    <message>
        <source>Redo</source>
        <translation>Wieder</translation>
    </message>
    <message>
        <source>Makes the edit again that was taken back</source>
        <translation>Macht die zurückgenommene Änderung noch einmal</translation>
    </message>
    <message>
        <source>There are edits that are not saved</source>
        <translation>Es gibt Änderungen, die nicht gespeichert sind</translation>
    </message>
    <message>
        <source>Nothing was edited</source>
        <translation>Nichts wurde geändert</translation>
    </message>
    <message>
        <source>Nothing is left to save</source>
        <translation>Alles ist gespeichert</translation>
    </message>
    <message>
        <source>Shape of the tool</source>
        <translation>Form des Werkzeugs</translation>
    </message>
    <message>
        <source>Where half of the effect is left, in the volume: from a voxel to a quarter of the grid. With the shape of the tool: how far from its skin; with less than a voxel, sharp corners stay where they are</source>
        <translation>Wo noch die halbe Wirkung ist, im Volumen: von einem Voxel bis zu einem Viertel des Gitters. Mit der Form des Werkzeugs: wie weit von seiner Haut; bei weniger als einem Voxel bleiben scharfe Ecken stehen</translation>
    </message>
    <message>
        <source>The brush works with what the tool is, also while it turns</source>
        <translation>Der Pinsel wirkt mit dem, was das Werkzeug ist, auch während es sich dreht</translation>
    </message>
    <message>
        <source>Take a tool on the page Feel first</source>
        <translation>Wählen Sie zuerst auf der Seite „Fühlen“ ein Werkzeug</translation>
    </message>
    <message>
        <source>A sequence cannot be edited: open one frame of it (--time-step).</source>
        <translation>Eine Sequenz lässt sich nicht bearbeiten: Öffnen Sie ein Bild davon (--time-step).</translation>
    </message>
    <message>
        <source>There is nothing to undo</source>
        <translation>Es gibt nichts rückgängig zu machen</translation>
    </message>
    <message>
        <source>There is nothing to redo</source>
        <translation>Es gibt nichts wiederherzustellen</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Connector</name>
    <message>
        <source>Connecting to %1</source>
        <translation>Verbinden mit %1</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::DeviceControls</name>
    <message>
        <source>connecting</source>
        <translation>verbindet</translation>
    </message>
    <message>
        <source>ready</source>
        <translation>bereit</translation>
    </message>
    <message>
        <source>needs calibration</source>
        <translation>muss kalibriert werden</translation>
    </message>
    <message>
        <source>sends no new positions</source>
        <translation>sendet keine neuen Positionen</translation>
    </message>
    <message>
        <source>connection lost</source>
        <translation>Verbindung verloren</translation>
    </message>
    <message>
        <source>reports a fault</source>
        <translation>meldet einen Fehler</translation>
    </message>
    <message>
        <source>the hand has come to its end</source>
        <translation>die Hand ist an ihrem Ende angekommen</translation>
    </message>
    <message>
        <source>The simulated or recorded hand has come to its end</source>
        <translation>Die simulierte oder aufgezeichnete Hand ist an ihrem Ende angekommen</translation>
    </message>
    <message>
        <source>Devices; grey: not found, the tip says what was looked for</source>
        <translation>Geräte; grau: nicht gefunden, der Hinweis sagt, wonach gesucht wurde</translation>
    </message>
    <message>
        <source>Look again</source>
        <translation>Neu suchen</translation>
    </message>
    <message>
        <source>Look for devices again; takes about a second</source>
        <translation>Noch einmal nach Geräten suchen; dauert etwa eine Sekunde</translation>
    </message>
    <message>
        <source>Connect</source>
        <translation>Verbinden</translation>
    </message>
    <message>
        <source>Go on with this device; forces ramp up anew</source>
        <translation>Mit diesem Gerät weitermachen; die Kräfte steigen neu an</translation>
    </message>
    <message>
        <source>The box that the device reaches [mm of the hand], and its most force</source>
        <translation>Der Quader, den das Gerät erreicht [mm der Hand], und seine größte Kraft</translation>
    </message>
    <message>
        <source>Scale of the hand: mm in the volume for each mm of the hand. Changes about the proxy, so that neither it nor the force moves</source>
        <translation>Maßstab der Hand: mm im Volumen je mm der Hand. Ändert sich um den Proxy herum, sodass weder er noch die Kraft sich bewegt</translation>
    </message>
    <message>
        <source>Options of the device</source>
        <translation>Optionen des Geräts</translation>
    </message>
    <message>
        <source>State</source>
        <translation>Zustand</translation>
    </message>
    <message>
        <source>Model</source>
        <translation>Modell</translation>
    </message>
    <message>
        <source>Reach</source>
        <translation>Reichweite</translation>
    </message>
    <message>
        <source>Scale of the hand</source>
        <translation>Maßstab der Hand</translation>
    </message>
    <message>
        <source>%1 (not found)</source>
        <translation>%1 (nicht gefunden)</translation>
    </message>
    <message>
        <source>Options, KEY=VALUE with commas between</source>
        <translation>Optionen, SCHLÜSSEL=WERT mit Kommas dazwischen</translation>
    </message>
    <message>
        <source>up to %1 N</source>
        <translation>bis %1 N</translation>
    </message>
    <message>
        <source>gives no force</source>
        <translation>gibt keine Kraft</translation>
    </message>
    <message>
        <source>Add as second hand</source>
        <translation>Als zweite Hand hinzufügen</translation>
    </message>
    <message>
        <source>One more hand with the device above. Each feels what the other edits</source>
        <translation>Noch eine Hand mit dem Gerät darüber. Jede fühlt, was die andere verändert</translation>
    </message>
    <message>
        <source>Remove this hand</source>
        <translation>Diese Hand entfernen</translation>
    </message>
    <message>
        <source>Its force ends; the other hand goes on</source>
        <translation>Ihre Kraft endet; die andere Hand fühlt weiter</translation>
    </message>
    <message>
        <source>While this button is held, the volume hangs on the hand</source>
        <translation>Solange diese Taste gehalten wird, hängt das Volumen an der Hand</translation>
    </message>
    <message>
        <source>Clutch button</source>
        <translation>Kupplungstaste</translation>
    </message>
    <message>
        <source>There is a force only while this button is held</source>
        <translation>Nur solange diese Taste gehalten wird, gibt es eine Kraft</translation>
    </message>
    <message>
        <source>Dead-man button</source>
        <translation>Totmanntaste</translation>
    </message>
    <message>
        <source>none</source>
        <translation>keine</translation>
    </message>
    <message>
        <source>the second, or the only one</source>
        <translation>die zweite, oder die einzige</translation>
    </message>
    <message>
        <source>button %1</source>
        <translation>Taste %1</translation>
    </message>
    <message>
        <source>The device has no buttons</source>
        <translation>Das Gerät hat keine Tasten</translation>
    </message>
    <message>
        <source>Looking for devices</source>
        <translation>Geräte werden gesucht</translation>
    </message>
    <message>
        <source>No haptic device was found: the mouse is the hand.</source>
        <translation>Kein haptisches Gerät gefunden: Die Maus ist die Hand.</translation>
    </message>
    <message>
        <source>Found: %1. Choose it under Device.</source>
        <translation>Gefunden: %1. Wählen Sie es unter Gerät.</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Effect</name>
    <message>
        <source>A recording is played: nothing here changes it.</source>
        <translation>Eine Aufzeichnung läuft: Hier lässt sich nichts an ihr ändern.</translation>
    </message>
    <message>
        <source>layers are felt, not an isovalue: choose No layers to feel one</source>
        <translation>es werden Schichten gefühlt, kein Isowert: Wählen Sie „Keine Schichten“, um einen zu fühlen</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::FileController</name>
    <message>
        <source>Reading %1</source>
        <translation>%1 wird gelesen</translation>
    </message>
    <message>
        <source>Saved %1</source>
        <translation>%1 gespeichert</translation>
    </message>
    <message>
        <source>%1; felt through the device %2</source>
        <translation>%1; gefühlt mit dem Gerät %2</translation>
    </message>
    <message>
        <source>%1 channels, %2 times: Data &gt; Level, channel and time chooses another</source>
        <translation>%1 Kanäle, %2 Zeiten: Daten &gt; Detailstufe, Kanal und Zeit wählt anderes</translation>
    </message>
    <message>
        <source>The measurements are in no session file yet. Save the session?</source>
        <translation>Die Messungen sind noch in keiner Sitzungsdatei. Sitzung speichern?</translation>
    </message>
    <message>
        <source>The changed layers are in no file yet. Save them in the session?</source>
        <translation>Die geänderten Schichten sind noch in keiner Datei. In der Sitzung speichern?</translation>
    </message>
    <message>
        <source>Save the session</source>
        <translation>Sitzung speichern</translation>
    </message>
    <message>
        <source>Felt through the device %1</source>
        <translation>Gefühlt mit dem Gerät %1</translation>
    </message>
    <message>
        <source>Felt through the devices %1</source>
        <translation>Gefühlt mit den Geräten %1</translation>
    </message>
    <message>
        <source>Sessions (*.json)</source>
        <translation>Sitzungen (*.json)</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::ForceControls</name>
    <message>
        <source>Advanced</source>
        <translation>Erweitert</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::ForceGauge</name>
    <message>
        <source>Off: forces are switched off</source>
        <translation>Aus: Die Kräfte sind ausgeschaltet</translation>
    </message>
    <message>
        <source>Recovering: the proxy is leaving the solid</source>
        <translation>Erholung: Der Proxy verlässt das Feste</translation>
    </message>
    <message>
        <source>No input: the device gives no reliable position</source>
        <translation>Keine Eingabe: Das Gerät gibt keine verlässliche Position</translation>
    </message>
    <message>
        <source>Too late: a tick took too long, its force was cancelled</source>
        <translation>Zu spät: Ein Takt dauerte zu lange, seine Kraft wurde zurückgenommen</translation>
    </message>
    <message>
        <source>Waiting: forces begin when the hand is where they are small</source>
        <translation>Wartet: Kräfte beginnen, wenn die Hand dort ist, wo sie klein sind</translation>
    </message>
    <message>
        <source>Ramp: from zero to full force after a start or pause</source>
        <translation>Rampe: von null bis zur vollen Kraft nach Start oder Pause</translation>
    </message>
    <message>
        <source>Limit: the computed force is larger than the limit</source>
        <translation>Grenze: Die berechnete Kraft ist größer als die Grenze</translation>
    </message>
    <message>
        <source>Motors warm: the force is limited until they have cooled</source>
        <translation>Motoren warm: Die Kraft ist begrenzt, bis sie abgekühlt sind</translation>
    </message>
    <message>
        <source>Rate limit: the force may not change faster</source>
        <translation>Ratengrenze: Die Kraft darf sich nicht schneller ändern</translation>
    </message>
    <message>
        <source>off</source>
        <translation>aus</translation>
    </message>
    <message>
        <source>recovering</source>
        <translation>Erholung</translation>
    </message>
    <message>
        <source>not finite</source>
        <translation>nicht endlich</translation>
    </message>
    <message>
        <source>no input</source>
        <translation>keine Eingabe</translation>
    </message>
    <message>
        <source>too late</source>
        <translation>zu spät</translation>
    </message>
    <message>
        <source>waiting</source>
        <translation>wartet</translation>
    </message>
    <message>
        <source>ramp</source>
        <translation>Rampe</translation>
    </message>
    <message>
        <source>limit</source>
        <translation>Grenze</translation>
    </message>
    <message>
        <source>motors warm</source>
        <translation>Motoren warm</translation>
    </message>
    <message>
        <source>rate limit</source>
        <translation>Ratengrenze</translation>
    </message>
    <message>
        <source>Force on the hand [N] against the limit in use</source>
        <translation>Kraft auf die Hand [N] gegen die geltende Grenze</translation>
    </message>
    <message>
        <source>Force %1 N of %2 N %3</source>
        <translation>Kraft %1 N von %2 N %3</translation>
    </message>
    <message>
        <source>of %1 N</source>
        <translation>von %1 N</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::GridDialog</name>
    <message>
        <source>The spacing is known</source>
        <translation>Der Abstand ist bekannt</translation>
    </message>
    <message>
        <source>Exchange left and right</source>
        <translation>Links und rechts vertauschen</translation>
    </message>
    <message>
        <source>Orientation and spacing</source>
        <translation>Lage und Abstand</translation>
    </message>
    <message>
        <source>not known</source>
        <translation>nicht bekannt</translation>
    </message>
    <message>
        <source>to the left (L)</source>
        <translation>nach links (L)</translation>
    </message>
    <message>
        <source>to the right (R)</source>
        <translation>nach rechts (R)</translation>
    </message>
    <message>
        <source>to the back (P)</source>
        <translation>nach hinten (P)</translation>
    </message>
    <message>
        <source>to the front (A)</source>
        <translation>nach vorn (A)</translation>
    </message>
    <message>
        <source>to the head (S)</source>
        <translation>zum Kopf (S)</translation>
    </message>
    <message>
        <source>to the feet (I)</source>
        <translation>zu den Füßen (I)</translation>
    </message>
    <message>
        <source>%1 runs</source>
        <translation>%1 verläuft</translation>
    </message>
    <message>
        <source>The side of the body that this axis of the samples runs to</source>
        <translation>Die Seite des Körpers, zu der diese Achse der Werte verläuft</translation>
    </message>
    <message>
        <source>Spacing along %1 [mm]</source>
        <translation>Abstand entlang %1 [mm]</translation>
    </message>
    <message>
        <source>Between neighbouring samples</source>
        <translation>Zwischen benachbarten Werten</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::HandSwitch</name>
    <message>
        <source>The panel shows the settings of this hand (N: the next one). Commands, keys and the mouse are for it</source>
        <translation>Die Leiste zeigt die Einstellungen dieser Hand (N: die nächste). Befehle, Tasten und Maus gelten ihr</translation>
    </message>
    <message>
        <source>Hand %1: %2</source>
        <translation>Hand %1: %2</translation>
    </message>
    <message>
        <source>Settings of hand %1, %2</source>
        <translation>Einstellungen von Hand %1, %2</translation>
    </message>
    <message>
        <source>The panel shows the settings of hand %1</source>
        <translation>Die Leiste zeigt die Einstellungen von Hand %1</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Hints</name>
    <message>
        <source>Forces are off: the space bar switches them on</source>
        <translation>Die Kräfte sind aus: Die Leertaste schaltet sie ein</translation>
    </message>
    <message>
        <source>Frozen: F lets hand and proxy move again</source>
        <translation>Eingefroren: F lässt Hand und Proxy sich wieder bewegen</translation>
    </message>
    <message>
        <source>The volume hangs on the hand: C puts it down</source>
        <translation>Das Volumen hängt an der Hand: C setzt es ab</translation>
    </message>
    <message>
        <source>The hand has come to its end: connect it again under Device</source>
        <translation>Die Hand ist an ihrem Ende angekommen: unter Gerät erneut verbinden</translation>
    </message>
    <message>
        <source>Withdraw a little to feel forces again</source>
        <translation>Etwas zurückziehen, um wieder Kräfte zu fühlen</translation>
    </message>
    <message>
        <source>The brush is on: it changes what it touches (B: off)</source>
        <translation>Der Pinsel ist an: Er verändert, was er berührt (B: aus)</translation>
    </message>
    <message>
        <source>A recording is played: Esc leaves it</source>
        <translation>Eine Aufzeichnung wird abgespielt: Esc verlässt sie</translation>
    </message>
    <message>
        <source>Hand %1: %2</source>
        <translation>Hand %1: %2</translation>
    </message>
    <message>
        <source>%1 %2 deep, %3 N</source>
        <translation>%1 %2 tief, %3 N</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::IsovalueControls</name>
    <message>
        <source>Isovalue [data units]: the level whose surface is felt</source>
        <translation>Isowert [Dateneinheiten]: der Wert, dessen Oberfläche gefühlt wird</translation>
    </message>
    <message>
        <source>Which side of the level is solid: bright bodies on dark, or airways and vessels dark on bright.
The session starts anew, with penetrability off.</source>
        <translation>Welche Seite des Isowerts fest ist: helle Körper auf Dunkel, oder Atemwege und Gefäße dunkel auf Hell.
Die Sitzung beginnt neu, ohne Durchdrücken.</translation>
    </message>
    <message>
        <source>How densities continue between samples: cubic, smooth, or linear, with facets.
The session starts anew, with penetrability off.</source>
        <translation>Wie sich die Dichte zwischen den Abtastwerten fortsetzt: kubisch, glatt, oder linear, mit Facetten.
Die Sitzung beginnt neu, ohne Durchdrücken.</translation>
    </message>
    <message>
        <source>dequantize</source>
        <translation>dequantisieren</translation>
    </message>
    <message>
        <source>Give back what rounding to levels took, against terraces and the stair steps of masks.
The volume is read again; edits are lost.</source>
        <translation>Gibt zurück, was das Runden auf Stufen genommen hat, gegen Terrassen und die Treppenstufen von Masken.
Das Volumen wird neu gelesen; Änderungen gehen verloren.</translation>
    </message>
    <message>
        <source>The level felt now [data units]; another than the isovalue while penetrability lets the hand through</source>
        <translation>Der jetzt gefühlte Wert [Dateneinheiten]; ein anderer als der Isowert, solange die Hand durchdrückt</translation>
    </message>
    <message>
        <source>Isovalue</source>
        <translation>Isowert</translation>
    </message>
    <message>
        <source>above is solid</source>
        <translation>darüber ist fest</translation>
    </message>
    <message>
        <source>below is solid</source>
        <translation>darunter ist fest</translation>
    </message>
    <message>
        <source>linear</source>
        <translation>linear</translation>
    </message>
    <message>
        <source>cubic</source>
        <translation>kubisch</translation>
    </message>
    <message>
        <source>Dequantizing is worth it: %1.</source>
        <translation>Dequantisieren lohnt sich: %1.</translation>
    </message>
    <message>
        <source>The level felt follows the hand: pressing through is on.</source>
        <translation>Der gefühlte Wert folgt der Hand: Durchdrücken ist an.</translation>
    </message>
    <message>
        <source>Layers have levels of their own: drag their squares.</source>
        <translation>Schichten haben eigene Werte: Ziehen Sie ihre Quadrate.</translation>
    </message>
    <message>
        <source>felt %1</source>
        <translation>gefühlt %1</translation>
    </message>
    <message>
        <source>Layers are felt, not an isovalue: choose No layers to feel one</source>
        <translation>Es werden Schichten gefühlt, kein Isowert: Wählen Sie „Keine Schichten“, um einen zu fühlen</translation>
    </message>
    <message>
        <source>Layers by label are felt, not a level of the densities.</source>
        <translation>Es werden Schichten nach Labels gefühlt, kein Wert der Dichten.</translation>
    </message>
    <message>
        <source>the samples have two values, so surfaces are stair steps</source>
        <translation>die Samples haben zwei Werte, daher sind Oberflächen Treppen</translation>
    </message>
    <message>
        <source>rounding to levels of %1 makes terraces of %2 % of the surfaces and tilts them by %3 degrees</source>
        <translation>Runden auf Stufen von %1 macht %2 % der Oberflächen zu Terrassen und kippt sie um %3 Grad</translation>
    </message>
    <message>
        <source>It is a single slice: the cubic field has holes between samples that are little above the isovalue, the linear one has none.</source>
        <translation>Es ist eine einzelne Schicht: Das kubische Feld hat Löcher zwischen Samples, die wenig über dem Isowert liegen, das lineare hat keine.</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::LayersControls</name>
    <message>
        <source>Layers: several surfaces in one stroke</source>
        <translation>Schichten: mehrere Oberflächen in einem Zug</translation>
    </message>
    <message>
        <source>Open…</source>
        <translation>Öffnen …</translation>
    </message>
    <message>
        <source>A set of layers from a file (JSON)</source>
        <translation>Ein Schichtensatz aus einer Datei (JSON)</translation>
    </message>
    <message>
        <source>Save as…</source>
        <translation>Speichern …</translation>
    </message>
    <message>
        <source>This set of layers to a file (JSON), for these and other data</source>
        <translation>Diesen Schichtensatz in eine Datei (JSON), für diese und andere Daten</translation>
    </message>
    <message>
        <source>Undo the last change of layers</source>
        <translation>Die letzte Änderung der Schichten zurücknehmen</translation>
    </message>
    <message>
        <source>Redo the change of layers that was undone</source>
        <translation>Die zurückgenommene Änderung der Schichten wiederherstellen</translation>
    </message>
    <message>
        <source>Add</source>
        <translation>Hinzufügen</translation>
    </message>
    <message>
        <source>Another layer, where levels leave the most room; the first at the isovalue</source>
        <translation>Eine weitere Schicht, wo die Werte am meisten Platz lassen; die erste beim Isowert</translation>
    </message>
    <message>
        <source>Remove</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Remove the chosen layer</source>
        <translation>Die gewählte Schicht entfernen</translation>
    </message>
    <message>
        <source>The layer that is touched, and those that the proxy is in</source>
        <translation>Die Schicht, die berührt wird, und die, in denen der Proxy ist</translation>
    </message>
    <message>
        <source>Layers from outside in; choose one to change it. Their levels are lines to drag on the histogram</source>
        <translation>Schichten von außen nach innen; wählen Sie eine, um sie zu ändern. Ihre Werte sind Linien zum Ziehen auf dem Histogramm</translation>
    </message>
    <message>
        <source>Undo, layers</source>
        <translation>Rückgängig, Schichten</translation>
    </message>
    <message>
        <source>Redo, layers</source>
        <translation>Wiederherstellen, Schichten</translation>
    </message>
    <message>
        <source>Add a layer</source>
        <translation>Schicht hinzufügen</translation>
    </message>
    <message>
        <source>Remove the layer</source>
        <translation>Schicht entfernen</translation>
    </message>
    <message>
        <source>Open layers</source>
        <translation>Schichten öffnen</translation>
    </message>
    <message>
        <source>Save layers</source>
        <translation>Schichten speichern</translation>
    </message>
    <message>
        <source>Layers</source>
        <translation>Schichten</translation>
    </message>
    <message>
        <source>Clear</source>
        <translation>Leeren</translation>
    </message>
    <message>
        <source>Clear the plot of force by depth</source>
        <translation>Das Diagramm der Kraft über der Tiefe leeren</translation>
    </message>
    <message>
        <source>Clear the plot</source>
        <translation>Diagramm leeren</translation>
    </message>
    <message>
        <source>Layers, from outside in</source>
        <translation>Schichten, von außen nach innen</translation>
    </message>
    <message>
        <source>No layers: one surface</source>
        <translation>Keine Schichten</translation>
    </message>
    <message>
        <source>The surface of the isovalue is felt</source>
        <translation>Die Oberfläche des Isowerts wird gefühlt</translation>
    </message>
    <message>
        <source>%1 (changed)</source>
        <translation>%1 (geändert)</translation>
    </message>
    <message>
        <source>Several surfaces in one stroke, each with its own stiffness, friction and puncture force</source>
        <translation>Mehrere Oberflächen in einem Zug, jede mit eigener Steifigkeit, Reibung und Durchstoßkraft</translation>
    </message>
    <message>
        <source>rendered at %1 N/mm</source>
        <translation>wiedergegeben mit %1 N/mm</translation>
    </message>
    <message>
        <source>The device cannot render %1 N/mm stably with this damping and viscosity: it renders %2 N/mm</source>
        <translation>Das Gerät kann %1 N/mm bei dieser Dämpfung und Viskosität nicht stabil wiedergeben: Es gibt %2 N/mm wieder</translation>
    </message>
    <message>
        <source>touches no layer</source>
        <translation>berührt keine Schicht</translation>
    </message>
    <message>
        <source>Earlier in the list: a surface between two labels has the properties of the later one</source>
        <translation>Früher in der Liste: Eine Oberfläche zwischen zwei Labels hat die Eigenschaften des späteren</translation>
    </message>
    <message>
        <source>Later in the list: a surface between two labels has the properties of the later one</source>
        <translation>Später in der Liste: Eine Oberfläche zwischen zwei Labels hat die Eigenschaften des späteren</translation>
    </message>
    <message>
        <source>Layer earlier in the list</source>
        <translation>Schicht früher in der Liste</translation>
    </message>
    <message>
        <source>Layer later in the list</source>
        <translation>Schicht später in der Liste</translation>
    </message>
    <message>
        <source>The labels are chosen in the label map: show those to feel, on the page Data, and feel them again</source>
        <translation>Die Labels werden in der Labelkarte gewählt: Blenden Sie auf der Seite „Daten“ die gewünschten ein und fühlen Sie sie erneut</translation>
    </message>
    <message>
        <source>There are %1 layers at most</source>
        <translation>Es gibt höchstens %1 Schichten</translation>
    </message>
    <message>
        <source>Layers by label; choose one to change it. The order says which one counts where two meet</source>
        <translation>Schichten nach Labels; wählen Sie eine, um sie zu ändern. Die Reihenfolge bestimmt, welche gilt, wo zwei sich treffen</translation>
    </message>
    <message>
        <source>%1   label %2</source>
        <translation>%1   Label %2</translation>
    </message>
    <message>
        <source>layer</source>
        <comment>name of a new one, before its number</comment>
        <translation>Schicht</translation>
    </message>
    <message>
        <source>Name of the layer</source>
        <translation>Name der Schicht</translation>
    </message>
    <message>
        <source>Colour of the layer</source>
        <translation>Farbe der Schicht</translation>
    </message>
    <message>
        <source>Name</source>
        <translation>Name</translation>
    </message>
    <message>
        <source>Name and colour of the layer</source>
        <translation>Name und Farbe der Schicht</translation>
    </message>
    <message>
        <source>Its level [data units]; also a line to drag on the histogram</source>
        <translation>Ihr Wert [Dateneinheiten]; auch eine Linie zum Ziehen auf dem Histogramm</translation>
    </message>
    <message>
        <source>Level of the layer</source>
        <translation>Wert der Schicht</translation>
    </message>
    <message>
        <source>Level</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>Label</source>
        <translation>Label</translation>
    </message>
    <message>
        <source>Its label: the number that its samples have in the label map</source>
        <translation>Ihr Label: die Zahl, die ihre Voxel in der Labelkarte haben</translation>
    </message>
    <message>
        <source>Opacity</source>
        <translation>Deckkraft</translation>
    </message>
    <message>
        <source>Opacity of the layer in the scene, 0 to 1</source>
        <translation>Deckkraft der Schicht in der Szene, 0 bis 1</translation>
    </message>
    <message>
        <source>Opacity of the layer</source>
        <translation>Deckkraft der Schicht</translation>
    </message>
    <message>
        <source>%1 of the layer</source>
        <translation>%1 der Schicht</translation>
    </message>
    <message>
        <source>Clear the layer&apos;s own value</source>
        <translation>Den eigenen Wert der Schicht löschen</translation>
    </message>
    <message>
        <source>Clear the layer&apos;s own value: %1</source>
        <translation>Den eigenen Wert der Schicht löschen: %1</translation>
    </message>
    <message>
        <source>%1.
Now from its curve over density</source>
        <translation>%1.
Jetzt aus der Kurve über der Dichte</translation>
    </message>
    <message>
        <source>%1.
Now from the session&apos;s value (Force)</source>
        <translation>%1.
Jetzt aus dem Wert der Sitzung (Kraft)</translation>
    </message>
    <message>
        <source>Clear the layer&apos;s own value: then its curve over density, %1, counts</source>
        <translation>Den eigenen Wert der Schicht löschen: Dann gilt die Kurve über der Dichte, %1</translation>
    </message>
    <message>
        <source>Clear the layer&apos;s own value: then the session&apos;s value (Force), %1, counts</source>
        <translation>Den eigenen Wert der Schicht löschen: Dann gilt der Wert der Sitzung (Kraft), %1</translation>
    </message>
    <message>
        <source>never gives way</source>
        <translation>gibt nie nach</translation>
    </message>
    <message>
        <source>The surface holds, however hard the hand presses</source>
        <translation>Die Oberfläche hält, wie stark die Hand auch drückt</translation>
    </message>
    <message>
        <source>Closes after</source>
        <translation>Schließt nach</translation>
    </message>
    <message>
        <source>A surface that gave way closes when the proxy is farther than this from where it did, in the volume</source>
        <translation>Eine Fläche, die nachgab, schließt sich, wenn der Proxy im Volumen weiter als so von der Stelle entfernt ist</translation>
    </message>
    <message>
        <source>Distance at which surfaces close</source>
        <translation>Abstand, ab dem Flächen sich schließen</translation>
    </message>
    <message>
        <source>Needle</source>
        <translation>Nadel</translation>
    </message>
    <message>
        <source>The hand holds a needle: after the first puncture it moves along a line</source>
        <translation>Die Hand hält eine Nadel: Nach dem ersten Durchstoß bewegt sie sich entlang einer Linie</translation>
    </message>
    <message>
        <source>Lateral stiffness</source>
        <translation>Seitliche Steifigkeit</translation>
    </message>
    <message>
        <source>How stiffly the needle is drawn to its line [N/mm]</source>
        <translation>Wie steif die Nadel zu ihrer Linie gezogen wird [N/mm]</translation>
    </message>
    <message>
        <source>Static ratio</source>
        <translation>Haftverhältnis</translation>
    </message>
    <message>
        <source>Friction along the shaft at rest, of that in motion (no unit, 1 or more)</source>
        <translation>Reibung entlang des Schafts in Ruhe, im Verhältnis zu der in Bewegung (ohne Einheit, 1 oder mehr)</translation>
    </message>
    <message>
        <source>Stick speed</source>
        <translation>Hafttempo</translation>
    </message>
    <message>
        <source>Slower than this along its line, the shaft sticks [mm/s]</source>
        <translation>Langsamer als so entlang seiner Linie haftet der Schaft [mm/s]</translation>
    </message>
    <message>
        <source>The property whose curve over density lies over the histogram; in brackets the number of points of its curves.
A layer that has no value of its own takes it from there.</source>
        <translation>Die Eigenschaft, deren Kurve über der Dichte auf dem Histogramm liegt; in Klammern die Zahl der Punkte ihrer Kurven.
Eine Schicht ohne eigenen Wert nimmt ihn von dort.</translation>
    </message>
    <message>
        <source>Property of the curves</source>
        <translation>Eigenschaft der Kurven</translation>
    </message>
    <message>
        <source>Start</source>
        <translation>Beginnen</translation>
    </message>
    <message>
        <source>Begin a curve of this property: one point, with the value that counts so far.
On the histogram: double click for another point, drag it, right click or Del to delete it</source>
        <translation>Eine Kurve dieser Eigenschaft beginnen: ein Punkt mit dem Wert, der bisher gilt.
Auf dem Histogramm: Doppelklick für einen weiteren Punkt, ihn ziehen, Rechtsklick oder Entf löscht ihn</translation>
    </message>
    <message>
        <source>Start the curve</source>
        <translation>Kurve beginnen</translation>
    </message>
    <message>
        <source>Remove this curve</source>
        <translation>Diese Kurve entfernen</translation>
    </message>
    <message>
        <source>Remove the curve</source>
        <translation>Kurve entfernen</translation>
    </message>
    <message>
        <source>Begin a factor over the gradient&apos;s magnitude: the property, wherever it comes from, is multiplied by it.
Steep places, where two tissues meet, then feel different from flat ones</source>
        <translation>Einen Faktor über dem Betrag des Gradienten beginnen: Die Eigenschaft, woher sie auch kommt, wird mit ihm multipliziert.
Steile Stellen, wo zwei Gewebe sich treffen, fühlen sich dann anders an als flache</translation>
    </message>
    <message>
        <source>Start the factor over the gradient</source>
        <translation>Den Faktor über dem Gradienten beginnen</translation>
    </message>
    <message>
        <source>Remove the factor over the gradient</source>
        <translation>Den Faktor über dem Gradienten entfernen</translation>
    </message>
    <message>
        <source>Factor over the gradient</source>
        <translation>Faktor über dem Gradienten</translation>
    </message>
    <message>
        <source>Factor over the gradient&apos;s magnitude [data units / mm]; behind it, how often there is which (logarithm).
Points: drag; double click adds one, right click or Del deletes. By keys:
Page keys choose a point, arrows move it, Insert adds one.
Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again.</source>
        <translation>Faktor über dem Betrag des Gradienten [Dateneinheiten / mm]; dahinter, wie oft es welchen gibt (Logarithmus).
Punkte: ziehen; Doppelklick setzt einen dazu, Rechtsklick oder Entf löscht. Mit Tasten:
Bild auf und ab wählen einen Punkt, Pfeile verschieben ihn, Einfg setzt einen dazu.
Strg-Rad vergrößert, Umschalt-Rad verschiebt, Strg+0 zeigt wieder alles.</translation>
    </message>
    <message>
        <source>Each layer has a value of its own: clear one (×) to let the curve count.</source>
        <translation>Jede Schicht hat einen eigenen Wert: Löschen Sie einen (×), damit die Kurve gilt.</translation>
    </message>
    <message>
        <source>Curve</source>
        <translation>Kurve</translation>
    </message>
    <message>
        <source>over density</source>
        <translation>über der Dichte</translation>
    </message>
    <message>
        <source>over the gradient</source>
        <translation>über dem Gradienten</translation>
    </message>
    <message>
        <source>Stiffness</source>
        <translation>Steifigkeit</translation>
    </message>
    <message>
        <source>Stiffness of the layer&apos;s surface [N/mm]</source>
        <translation>Steifigkeit der Oberfläche der Schicht [N/mm]</translation>
    </message>
    <message>
        <source>Static friction</source>
        <translation>Haftreibung</translation>
    </message>
    <message>
        <source>Coefficient past which the proxy begins to slide on the surface (no unit)</source>
        <translation>Koeffizient, ab dem der Proxy auf der Oberfläche zu gleiten beginnt (ohne Einheit)</translation>
    </message>
    <message>
        <source>Dynamic friction</source>
        <translation>Gleitreibung</translation>
    </message>
    <message>
        <source>Coefficient while it slides; counts as at most the static one</source>
        <translation>Koeffizient, solange er gleitet; zählt höchstens wie der der Haftreibung</translation>
    </message>
    <message>
        <source>Damping</source>
        <translation>Dämpfung</translation>
    </message>
    <message>
        <source>Of the surface, against motion along its normal [N s/mm]</source>
        <translation>Der Oberfläche, gegen Bewegung längs ihrer Normalen [N s/mm]</translation>
    </message>
    <message>
        <source>Viscosity</source>
        <translation>Viskosität</translation>
    </message>
    <message>
        <source>Of what lies behind the surface, against all motion there [N s/mm]</source>
        <translation>Dessen, was hinter der Oberfläche liegt, gegen jede Bewegung dort [N s/mm]</translation>
    </message>
    <message>
        <source>Puncture force</source>
        <translation>Durchstoßkraft</translation>
    </message>
    <message>
        <source>Force of the press at which the surface gives way [N]</source>
        <translation>Kraft, bei der die Oberfläche nachgibt [N]</translation>
    </message>
    <message>
        <source>Drag</source>
        <translation>Schaftreibung</translation>
    </message>
    <message>
        <source>Rubbing on a needle&apos;s shaft for each millimetre of it in the layer [N/mm]; without a needle there is none</source>
        <translation>Reibung am Schaft einer Nadel je Millimeter in der Schicht [N/mm]; ohne Nadel gibt es keine</translation>
    </message>
    <message>
        <source>These layers are by label: open a label map over the volume first (page Data)</source>
        <translation>Diese Schichten gehen nach Labels: Öffnen Sie zuerst eine Labelkarte über dem Volumen (Seite „Daten“)</translation>
    </message>
    <message>
        <source>The label map has no label %1</source>
        <translation>Die Labelkarte hat kein Label %1</translation>
    </message>
    <message>
        <source>A layer for each label of the label map. A surface between two labels has the properties of the later one in the list.</source>
        <translation>Eine Schicht für jedes Label der Labelkarte. Eine Oberfläche zwischen zwei Labels hat die Eigenschaften des späteren in der Liste.</translation>
    </message>
    <message>
        <source>All labels are hidden: show those to feel</source>
        <translation>Alle Labels sind ausgeblendet: Blenden Sie die ein, die gefühlt werden sollen</translation>
    </message>
    <message>
        <source>%1. Hide labels in the list to feel the others</source>
        <translation>%1. Blenden Sie Labels in der Liste aus, um die anderen zu fühlen</translation>
    </message>
    <message>
        <source>Looking for the labels</source>
        <translation>Labels werden gesucht</translation>
    </message>
    <message>
        <source>Reading the labels</source>
        <translation>Labels werden gelesen</translation>
    </message>
    <message>
        <source>%1: these are layers: open a volume first, and feel it, then open them</source>
        <translation>%1: Das sind Schichten: Öffnen und fühlen Sie zuerst ein Volumen, dann öffnen Sie sie</translation>
    </message>
    <message>
        <source>Save the layers</source>
        <translation>Schichten speichern</translation>
    </message>
    <message>
        <source>layers</source>
        <translation>schichten</translation>
    </message>
    <message>
        <source>Saved %1</source>
        <translation>%1 gespeichert</translation>
    </message>
    <message>
        <source>Layers (*.json);;All files (*)</source>
        <translation>Schichten (*.json);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Reading %1</source>
        <translation>%1 wird gelesen</translation>
    </message>
    <message>
        <source>For CT in Hounsfield units, which these data do not look like</source>
        <translation>Für CT in Hounsfield-Einheiten, wonach diese Daten nicht aussehen</translation>
    </message>
    <message>
        <source>Layers (*.json)</source>
        <translation>Schichten (*.json)</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::LevelChart</name>
    <message>
        <source>Isovalue on the histogram</source>
        <translation>Isowert auf dem Histogramm</translation>
    </message>
    <message>
        <source>Delete range %1 to %2</source>
        <translation>Bereich %1 bis %2 löschen</translation>
    </message>
    <message>
        <source>nothing is felt here</source>
        <translation>hier wird nichts gefühlt</translation>
    </message>
    <message>
        <source>no volume</source>
        <translation>kein Volumen</translation>
    </message>
    <message>
        <source>Histogram of the data (logarithm of the counts).
Drag: the isovalue. Arrow keys or wheel after a click: fine steps; Page keys: ten.
Squares on the lower edge: levels of layers and of other surfaces, to drag.
Points of a curve: drag; double click adds one, right click or Del deletes. By keys:
Page keys choose a point, arrows move it, Insert adds one.
Ticks on the upper edge: levels that are likely worth feeling.
Shift-drag: a new range of interest. Drag the strip below: move or resize it;
right click or Del: delete it.
Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again.</source>
        <translation>Histogramm der Daten (Logarithmus der Anzahlen).
Ziehen: der Isowert. Pfeiltasten oder Rad nach einem Klick: feine Schritte; Bild auf, ab: zehn.
Quadrate am unteren Rand: Werte von Schichten und anderen Flächen, zum Ziehen.
Punkte einer Kurve: ziehen; Doppelklick fügt einen hinzu, Rechtsklick oder Entf löscht. Mit Tasten:
Bild auf, ab wählt einen Punkt, Pfeiltasten bewegen ihn, Einfg fügt einen hinzu.
Striche am oberen Rand: Werte, die zu fühlen sich wohl lohnt.
Umschalt+Ziehen: ein neuer Wertebereich. Streifen darunter ziehen: verschieben oder ändern;
Rechtsklick oder Entf: löschen.
Strg+Rad zoomt, Umschalt+Rad verschiebt, Strg+0 zeigt wieder alles.</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::LookControls</name>
    <message>
        <source>Colour of the isosurface</source>
        <translation>Farbe der Isofläche</translation>
    </message>
    <message>
        <source>Colour of the chosen point</source>
        <translation>Farbe des gewählten Punkts</translation>
    </message>
    <message>
        <source>Transfer functions made for these data; choose one again to undo changes</source>
        <translation>Transferfunktionen für diese Daten; noch einmal wählen macht Änderungen rückgängig</translation>
    </message>
    <message>
        <source>Cut surfaces and volume open, to see inside. Drag the blue balls in the scene.
Choose the plane again to have it face you.</source>
        <translation>Flächen und Volumen aufschneiden, um hineinzusehen. Ziehen Sie die blauen Kugeln in der Szene.
Wählen Sie die Ebene noch einmal, damit sie zu Ihnen zeigt.</translation>
    </message>
    <message>
        <source>Colour map of the slices</source>
        <translation>Farbtabelle der Schnitte</translation>
    </message>
    <message>
        <source>Level of the chosen point [data units]</source>
        <translation>Wert des gewählten Punkts [Dateneinheiten]</translation>
    </message>
    <message>
        <source>Opacity of the chosen point, 0 to 1, of a layer as thick as the smallest spacing</source>
        <translation>Deckkraft des gewählten Punkts, 0 bis 1, einer Schicht so dick wie der kleinste Abstand</translation>
    </message>
    <message>
        <source>Opacity of the isosurface</source>
        <translation>Deckkraft der Isofläche</translation>
    </message>
    <message>
        <source>Opacity of the isosurface, 0 to 1</source>
        <translation>Deckkraft der Isofläche, 0 bis 1</translation>
    </message>
    <message>
        <source>Surface</source>
        <translation>Fläche</translation>
    </message>
    <message>
        <source>The isosurface that is felt</source>
        <translation>Die Isofläche, die gefühlt wird</translation>
    </message>
    <message>
        <source>nothing</source>
        <translation>nichts</translation>
    </message>
    <message>
        <source>by a plane</source>
        <translation>mit einer Ebene</translation>
    </message>
    <message>
        <source>to a box</source>
        <translation>auf einen Quader</translation>
    </message>
    <message>
        <source>Cut away</source>
        <translation>Wegschneiden</translation>
    </message>
    <message>
        <source>Volume</source>
        <translation>Volumen</translation>
    </message>
    <message>
        <source>Volume rendering by the transfer function</source>
        <translation>Volumendarstellung nach der Transferfunktion</translation>
    </message>
    <message>
        <source>Shading</source>
        <translation>Schattierung</translation>
    </message>
    <message>
        <source>Light on the volume, by its gradients</source>
        <translation>Licht auf dem Volumen, nach seinen Gradienten</translation>
    </message>
    <message>
        <source>Maximum</source>
        <translation>Maximum</translation>
    </message>
    <message>
        <source>Maximum intensity projection: the brightest sample along each line of sight, black to white over the levels below</source>
        <translation>Maximumintensitätsprojektion (MIP): der hellste Abtastwert entlang jeder Sichtlinie, schwarz bis weiß über den Werten darunter</translation>
    </message>
    <message>
        <source>Point</source>
        <translation>Punkt</translation>
    </message>
    <message>
        <source>Slices</source>
        <translation>Schnitte</translation>
    </message>
    <message>
        <source>Three planes through the crosshair</source>
        <translation>Drei Ebenen durch das Fadenkreuz</translation>
    </message>
    <message>
        <source>Hand and proxy</source>
        <translation>Hand und Proxy</translation>
    </message>
    <message>
        <source>HIP, SCP, the spring between them and the force</source>
        <translation>HIP, SCP, die Feder zwischen ihnen und die Kraft</translation>
    </message>
    <message>
        <source>Tetrahedra</source>
        <translation>Tetraeder</translation>
    </message>
    <message>
        <source>Those round the proxy, with the surface in them</source>
        <translation>Die um den Proxy, mit der Fläche in ihnen</translation>
    </message>
    <message>
        <source>Constraint planes</source>
        <translation>Zwangsebenen</translation>
    </message>
    <message>
        <source>Those of the tetrahedra round the proxy</source>
        <translation>Die der Tetraeder um den Proxy</translation>
    </message>
    <message>
        <source>Box</source>
        <translation>Quader</translation>
    </message>
    <message>
        <source>The bounds of the data</source>
        <translation>Die Grenzen der Daten</translation>
    </message>
    <message>
        <source>Orientation cube</source>
        <translation>Orientierungswürfel</translation>
    </message>
    <message>
        <source>L, R, A, P, S, I: sides of the body</source>
        <translation>L, R, A, P, S, I: Seiten des Körpers</translation>
    </message>
    <message>
        <source>Scale bar</source>
        <translation>Maßstab</translation>
    </message>
    <message>
        <source>A length in the picture</source>
        <translation>Eine Länge im Bild</translation>
    </message>
    <message>
        <source>Slices&apos; colours</source>
        <translation>Farben der Schnitte</translation>
    </message>
    <message>
        <source>Layers are felt, not an isovalue: choose No layers to feel one</source>
        <translation>Es werden Schichten gefühlt, kein Isowert: Wählen Sie „Keine Schichten“, um einen zu fühlen</translation>
    </message>
    <message>
        <source>Opacity (upwards, 0 to 1) and colour by level [data units].
Drag a point; double click adds one, or on a point chooses its colour; right click or Del deletes.
Page keys choose a point, arrows move it, Insert adds one, Return chooses its colour.
Choose the preset again to undo. Ctrl-wheel zooms, shift-wheel moves, Ctrl+0 shows all again.</source>
        <translation>Deckkraft (aufwärts, 0 bis 1) und Farbe nach Wert [Dateneinheiten].
Punkte ziehen; Doppelklick fügt einen hinzu oder wählt auf einem Punkt seine Farbe; Rechtsklick oder Entf löscht.
Die Bild-Tasten wählen einen Punkt, Pfeile bewegen ihn, Einfg fügt einen hinzu, Eingabe wählt seine Farbe.
Die Vorlage noch einmal wählen macht rückgängig. Strg+Rad zoomt, Umschalt+Rad verschiebt, Strg+0 zeigt wieder alles.</translation>
    </message>
    <message>
        <source>Transfer function</source>
        <translation>Transferfunktion</translation>
    </message>
    <message>
        <source>Add a surface</source>
        <translation>Fläche hinzufügen</translation>
    </message>
    <message>
        <source>See another level beside the one that is felt: skin over bone</source>
        <translation>Einen weiteren Wert neben dem gefühlten sehen: Haut über Knochen</translation>
    </message>
    <message>
        <source>Its level [data units]; also a line to drag on the histogram</source>
        <translation>Ihr Wert [Dateneinheiten]; auch eine Linie zum Ziehen auf dem Histogramm</translation>
    </message>
    <message>
        <source>Level of surface %1</source>
        <translation>Wert von Fläche %1</translation>
    </message>
    <message>
        <source>Its opacity, 0 to 1</source>
        <translation>Ihre Deckkraft, 0 bis 1</translation>
    </message>
    <message>
        <source>Opacity of surface %1</source>
        <translation>Deckkraft von Fläche %1</translation>
    </message>
    <message>
        <source>Feel</source>
        <translation>Fühlen</translation>
    </message>
    <message>
        <source>Feel this one; the one felt now takes its place here</source>
        <translation>Diese fühlen; die jetzt gefühlte nimmt hier ihren Platz ein</translation>
    </message>
    <message>
        <source>Feel surface %1</source>
        <translation>Fläche %1 fühlen</translation>
    </message>
    <message>
        <source>Remove it</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Remove surface %1</source>
        <translation>Fläche %1 entfernen</translation>
    </message>
    <message>
        <source>Surface %1 is seen</source>
        <translation>Fläche %1 ist zu sehen</translation>
    </message>
    <message>
        <source>Surface %1</source>
        <translation>Fläche %1</translation>
    </message>
    <message>
        <source>Colour of surface %1</source>
        <translation>Farbe von Fläche %1</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::LoopView</name>
    <message>
        <source>Ticks per second, as measured [Hz]</source>
        <translation>Takte je Sekunde, gemessen [Hz]</translation>
    </message>
    <message>
        <source>Deadlines: ticks that did not happen at their time; and forces that were cancelled because a tick took too long</source>
        <translation>Fristen: Takte, die nicht zu ihrer Zeit stattfanden; und Kräfte, die zurückgenommen wurden, weil ein Takt zu lange dauerte</translation>
    </message>
    <message>
        <source>Rate</source>
        <translation>Rate</translation>
    </message>
    <message>
        <source>Missed</source>
        <translation>Verpasst</translation>
    </message>
    <message>
        <source>Lateness</source>
        <translation>Verspätung</translation>
    </message>
    <message>
        <source>Compute</source>
        <translation>Rechenzeit</translation>
    </message>
    <message>
        <source>Worst tick</source>
        <translation>Schlechtester</translation>
    </message>
    <message>
        <source>Lateness: how late a tick began, caused by the rest of the machine.
Compute: processor time of a tick.</source>
        <translation>Verspätung: wie spät ein Takt begann, verursacht vom Rest des Rechners.
Rechenzeit: Prozessorzeit eines Takts.</translation>
    </message>
    <message>
        <source>%1 Hz</source>
        <translation>%1 Hz</translation>
    </message>
    <message>
        <source>%1 of %2 ticks</source>
        <translation>%1 von %2 Takten</translation>
    </message>
    <message numerus="yes">
        <source>%n forces cancelled</source>
        <translation>
            <numerusform>%n Kraft zurückgenommen</numerusform>
            <numerusform>%n Kräfte zurückgenommen</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>%n not recorded</source>
        <translation>
            <numerusform>%n nicht aufgezeichnet</numerusform>
            <numerusform>%n nicht aufgezeichnet</numerusform>
        </translation>
    </message>
    <message>
        <source>none yet</source>
        <translation>noch keiner</translation>
    </message>
    <message>
        <source>%1, mostly %2</source>
        <translation>%1, meist %2</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::MainWindow</name>
    <message>
        <source>Feel and look</source>
        <translation>Fühlen und Sehen</translation>
    </message>
    <message>
        <source>Open a volume, or drop one here (Ctrl+O); ? lists the shortcuts</source>
        <translation>Öffnen Sie ein Volumen oder legen Sie es hier ab (Strg+O); ? zeigt die Tastenkürzel</translation>
    </message>
    <message>
        <source>%1[*]%2 – Palpate</source>
        <translation>%1[*]%2 – Palpate</translation>
    </message>
    <message>
        <source>%1 ms a frame</source>
        <translation>%1 ms je Bild</translation>
    </message>
    <message>
        <source>Saved %1</source>
        <translation>%1 gespeichert</translation>
    </message>
    <message>
        <source>nothing yet</source>
        <translation>noch nichts</translation>
    </message>
    <message>
        <source>&amp;Open…</source>
        <translation>Ö&amp;ffnen …</translation>
    </message>
    <message>
        <source>Open raw &amp;data…</source>
        <translation>Roh&amp;daten öffnen …</translation>
    </message>
    <message>
        <source>Open &amp;recent</source>
        <translation>Zule&amp;tzt geöffnet</translation>
    </message>
    <message>
        <source>&amp;Save the session</source>
        <translation>&amp;Sitzung speichern</translation>
    </message>
    <message>
        <source>Save the session &amp;as…</source>
        <translation>Sitzung speichern &amp;unter …</translation>
    </message>
    <message>
        <source>Save a picture</source>
        <translation>Bild speichern</translation>
    </message>
    <message>
        <source>&amp;Picture of the scene…</source>
        <translation>Bild der S&amp;zene …</translation>
    </message>
    <message>
        <source>Picture of the &amp;window…</source>
        <translation>Bild des Fe&amp;nsters …</translation>
    </message>
    <message>
        <source>&amp;File</source>
        <translation>&amp;Datei</translation>
    </message>
    <message>
        <source>Pr&amp;eferences…</source>
        <translation>&amp;Einstellungen …</translation>
    </message>
    <message>
        <source>&amp;Quit</source>
        <translation>&amp;Beenden</translation>
    </message>
    <message>
        <source>Record the session</source>
        <translation>Sitzung aufzeichnen</translation>
    </message>
    <message>
        <source>&amp;Record…</source>
        <translation>&amp;Aufzeichnen …</translation>
    </message>
    <message>
        <source>Leave the recordin&amp;g, feel again</source>
        <translation>Aufzeichnung &amp;verlassen, wieder fühlen</translation>
    </message>
    <message>
        <source>&amp;Session</source>
        <translation>&amp;Sitzung</translation>
    </message>
    <message>
        <source>&amp;Forces on</source>
        <translation>&amp;Kräfte an</translation>
    </message>
    <message>
        <source>Free&amp;ze</source>
        <translation>&amp;Einfrieren</translation>
    </message>
    <message>
        <source>&amp;Clutch: the volume follows the hand</source>
        <translation>Ku&amp;ppeln: Das Volumen folgt der Hand</translation>
    </message>
    <message>
        <source>&amp;Mouse moves the probe</source>
        <translation>&amp;Maus bewegt die Sonde</translation>
    </message>
    <message>
        <source>Isovalue &amp;up by 1 %</source>
        <translation>Isowert um 1 % &amp;hinauf</translation>
    </message>
    <message>
        <source>Isovalue &amp;down by 1 %</source>
        <translation>Isowert um 1 % hina&amp;b</translation>
    </message>
    <message>
        <source>Hand &amp;larger in the volume</source>
        <translation>Hand im Volumen &amp;größer</translation>
    </message>
    <message>
        <source>Hand &amp;smaller in the volume</source>
        <translation>Hand im Volumen k&amp;leiner</translation>
    </message>
    <message>
        <source>&amp;Data</source>
        <translation>Da&amp;ten</translation>
    </message>
    <message>
        <source>&amp;Brush at the probe</source>
        <translation>&amp;Pinsel an der Sonde</translation>
    </message>
    <message>
        <source>&amp;Undo</source>
        <translation>&amp;Rückgängig</translation>
    </message>
    <message>
        <source>&amp;Redo</source>
        <translation>&amp;Wiederherstellen</translation>
    </message>
    <message>
        <source>&amp;Save the volume…</source>
        <translation>&amp;Volumen speichern …</translation>
    </message>
    <message>
        <source>Save the surface as a &amp;mesh…</source>
        <translation>Oberfläche als &amp;Netz speichern …</translation>
    </message>
    <message>
        <source>Open an o&amp;verlay: labels or another image…</source>
        <translation>Überla&amp;gerung öffnen: Labels oder ein anderes Bild …</translation>
    </message>
    <message>
        <source>&amp;Close the overlay</source>
        <translation>Überlagerung s&amp;chließen</translation>
    </message>
    <message>
        <source>&amp;Play the sequence, or pause it</source>
        <translation>&amp;Sequenz abspielen oder anhalten</translation>
    </message>
    <message>
        <source>A frame bac&amp;k</source>
        <translation>Ein Bild &amp;zurück</translation>
    </message>
    <message>
        <source>A frame &amp;on</source>
        <translation>Ein Bild v&amp;or</translation>
    </message>
    <message>
        <source>From the front</source>
        <translation>Von vorn</translation>
    </message>
    <message>
        <source>From the back</source>
        <translation>Von hinten</translation>
    </message>
    <message>
        <source>From the left</source>
        <translation>Von links</translation>
    </message>
    <message>
        <source>From the right</source>
        <translation>Von rechts</translation>
    </message>
    <message>
        <source>From the top</source>
        <translation>Von oben</translation>
    </message>
    <message>
        <source>From the bottom</source>
        <translation>Von unten</translation>
    </message>
    <message>
        <source>&amp;Whole volume</source>
        <translation>&amp;Ganzes Volumen</translation>
    </message>
    <message>
        <source>From the &amp;hand</source>
        <translation>Von der &amp;Hand</translation>
    </message>
    <message>
        <source>&amp;Measure</source>
        <translation>&amp;Messen</translation>
    </message>
    <message>
        <source>A &amp;length</source>
        <translation>Eine &amp;Länge</translation>
    </message>
    <message>
        <source>An &amp;angle</source>
        <translation>Einen &amp;Winkel</translation>
    </message>
    <message>
        <source>&amp;Remove the last</source>
        <translation>Letzte Messung &amp;entfernen</translation>
    </message>
    <message>
        <source>R&amp;emove all</source>
        <translation>&amp;Alle entfernen</translation>
    </message>
    <message>
        <source>Cut awa&amp;y</source>
        <translation>&amp;Wegschneiden</translation>
    </message>
    <message>
        <source>&amp;Nothing</source>
        <translation>&amp;Nichts</translation>
    </message>
    <message>
        <source>By a &amp;plane that faces you</source>
        <translation>Mit einer &amp;Ebene, die zu Ihnen zeigt</translation>
    </message>
    <message>
        <source>To a &amp;box</source>
        <translation>Auf einen &amp;Quader</translation>
    </message>
    <message>
        <source>&amp;View</source>
        <translation>&amp;Ansicht</translation>
    </message>
    <message>
        <source>&amp;Slices beside the scene</source>
        <translation>&amp;Schnitte neben der Szene</translation>
    </message>
    <message>
        <source>Scene with slices &amp;beside it</source>
        <translation>Szene mit Schnitten &amp;daneben</translation>
    </message>
    <message>
        <source>Four &amp;panes</source>
        <translation>&amp;Vier Felder</translation>
    </message>
    <message>
        <source>Scene a&amp;lone, or all panes</source>
        <translation>N&amp;ur die Szene, oder alle Felder</translation>
    </message>
    <message>
        <source>A slice al&amp;one, then the next</source>
        <translation>Nur &amp;ein Schnitt, dann der nächste</translation>
    </message>
    <message>
        <source>&amp;Crosshair follows the probe</source>
        <translation>&amp;Fadenkreuz folgt der Sonde</translation>
    </message>
    <message>
        <source>&amp;Full screen</source>
        <translation>Voll&amp;bild</translation>
    </message>
    <message>
        <source>&amp;Appearance</source>
        <translation>E&amp;rscheinungsbild</translation>
    </message>
    <message>
        <source>As the &amp;system</source>
        <translation>Wie das &amp;System</translation>
    </message>
    <message>
        <source>&amp;Light</source>
        <translation>&amp;Hell</translation>
    </message>
    <message>
        <source>&amp;Dark</source>
        <translation>&amp;Dunkel</translation>
    </message>
    <message>
        <source>&amp;Help</source>
        <translation>&amp;Hilfe</translation>
    </message>
    <message>
        <source>&amp;First steps</source>
        <translation>&amp;Erste Schritte</translation>
    </message>
    <message>
        <source>&amp;Shortcuts</source>
        <translation>&amp;Tastenkürzel</translation>
    </message>
    <message>
        <source>&amp;About Palpate</source>
        <translation>&amp;Über Palpate</translation>
    </message>
    <message>
        <source>Tools</source>
        <translation>Werkzeuge</translation>
    </message>
    <message>
        <source>Layout</source>
        <translation>Anordnung</translation>
    </message>
    <message>
        <source>Open a &amp;folder (DICOM, TIFF, Zarr)…</source>
        <translation>&amp;Ordner öffnen (DICOM, TIFF, Zarr) …</translation>
    </message>
    <message>
        <source>Open a&amp;n address…</source>
        <translation>&amp;Adresse öffnen …</translation>
    </message>
    <message>
        <source>&amp;Level, channel and time…</source>
        <translation>Detailst&amp;ufe, Kanal und Zeit …</translation>
    </message>
    <message>
        <source>No spacing in the file</source>
        <translation>Kein Abstand in der Datei</translation>
    </message>
    <message>
        <source>No orientation in the file</source>
        <translation>Keine Lage in der Datei</translation>
    </message>
    <message>
        <source>No orientation and no spacing in the file</source>
        <translation>Keine Lage und kein Abstand in der Datei</translation>
    </message>
    <message>
        <source>Or&amp;ientation and spacing…</source>
        <translation>&amp;Lage und Abstand …</translation>
    </message>
    <message>
        <source>From %1</source>
        <translation>Von %1</translation>
    </message>
    <message>
        <source>From a corner</source>
        <translation>Von einer Ecke</translation>
    </message>
    <message>
        <source>Settings of the &amp;next hand</source>
        <translation>Einstellungen der &amp;nächsten Hand</translation>
    </message>
    <message>
        <source>%1 %2   slope %3 /%4</source>
        <translation>%1 %2   Steigung %3 /%4</translation>
    </message>
    <message numerus="yes">
        <source>%n files were dropped: drop one, or the folder of slices</source>
        <translation>
            <numerusform>%n Datei wurde abgelegt: Legen Sie eine ab, oder den Ordner der Schichtbilder</numerusform>
            <numerusform>%n Dateien wurden abgelegt: Legen Sie eine ab, oder den Ordner der Schichtbilder</numerusform>
        </translation>
    </message>
    <message>
        <source>The overlay may lie elsewhere</source>
        <translation>Die Überlagerung liegt vielleicht woanders</translation>
    </message>
    <message>
        <source>Sides of the body are not known: say how the volume lies, and its spacing</source>
        <translation>Die Seiten des Körpers sind nicht bekannt: angeben, wie das Volumen liegt, und seinen Abstand</translation>
    </message>
    <message>
        <source>Pictures (*.png)</source>
        <translation>Bilder (*.png)</translation>
    </message>
    <message>
        <source>Recordings (*.csv)</source>
        <translation>Aufzeichnungen (*.csv)</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::MeasureController</name>
    <message>
        <source>Click two points on the surface or in a slice (Esc: give up)</source>
        <translation>Klicken Sie zwei Punkte auf der Fläche oder in einem Schnitt an (Esc: aufgeben)</translation>
    </message>
    <message>
        <source>Click a point on one side, the corner, and a point on the other side (Esc: give up)</source>
        <translation>Klicken Sie einen Punkt auf einem Schenkel, den Scheitel und einen Punkt auf dem anderen Schenkel an (Esc: aufgeben)</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::NumberBox</name>
    <message>
        <source>%1 can be read in two ways: type %2 or %3</source>
        <translation>%1 ist zweideutig: %2 oder %3 eingeben</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::OverlayControls</name>
    <message>
        <source>Open…</source>
        <translation>Öffnen …</translation>
    </message>
    <message>
        <source>A label map or another image of the same body, on a grid of its own</source>
        <translation>Eine Labelkarte oder ein anderes Bild desselben Körpers, auf eigenem Gitter</translation>
    </message>
    <message>
        <source>Close</source>
        <translation>Schließen</translation>
    </message>
    <message>
        <source>In slices</source>
        <translation>In Schnitten</translation>
    </message>
    <message>
        <source>Over the grey of the slices</source>
        <translation>Über dem Grau der Schnitte</translation>
    </message>
    <message>
        <source>In the scene</source>
        <translation>In der Szene</translation>
    </message>
    <message>
        <source>Surfaces of the labels, or of the image&apos;s level</source>
        <translation>Flächen der Labels oder des Bildwerts</translation>
    </message>
    <message>
        <source>Colour map of the image</source>
        <translation>Farbtabelle des Bildes</translation>
    </message>
    <message>
        <source>Level of the image&apos;s surface [its units]</source>
        <translation>Wert der Fläche des Bildes [dessen Einheiten]</translation>
    </message>
    <message>
        <source>Labels; a double click goes to where one lies</source>
        <translation>Labels; ein Doppelklick geht dorthin, wo eines liegt</translation>
    </message>
    <message>
        <source>Opacity of the overlay in slices</source>
        <translation>Deckkraft der Überlagerung in Schnitten</translation>
    </message>
    <message>
        <source>Opacity of the overlay&apos;s surfaces</source>
        <translation>Deckkraft der Flächen der Überlagerung</translation>
    </message>
    <message>
        <source>Labels</source>
        <translation>Labels</translation>
    </message>
    <message>
        <source>Colour map of the overlay</source>
        <translation>Farbtabelle der Überlagerung</translation>
    </message>
    <message>
        <source>Level of the overlay&apos;s surface</source>
        <translation>Wert der Fläche der Überlagerung</translation>
    </message>
    <message>
        <source>Colours</source>
        <translation>Farben</translation>
    </message>
    <message>
        <source>Level</source>
        <translation>Wert</translation>
    </message>
    <message>
        <source>Value %1</source>
        <translation>Wert %1</translation>
    </message>
    <message>
        <source>Feel these labels</source>
        <translation>Diese Labels fühlen</translation>
    </message>
    <message>
        <source>Layers by label: each label that is shown becomes one, with its name and colour; change them on the page Feel</source>
        <translation>Schichten nach Labels: Jedes eingeblendete Label wird eine, mit seinem Namen und seiner Farbe; ändern Sie sie auf der Seite „Fühlen“</translation>
    </message>
    <message>
        <source>Opening %1</source>
        <translation>%1 wird geöffnet</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Panel</name>
    <message>
        <source>Session</source>
        <translation>Sitzung</translation>
    </message>
    <message>
        <source>Isovalue</source>
        <translation>Isowert</translation>
    </message>
    <message>
        <source>Layers</source>
        <translation>Schichten</translation>
    </message>
    <message>
        <source>Edit</source>
        <translation>Bearbeiten</translation>
    </message>
    <message>
        <source>Force</source>
        <translation>Kraft</translation>
    </message>
    <message>
        <source>Device</source>
        <translation>Gerät</translation>
    </message>
    <message>
        <source>Advanced: servo loop</source>
        <translation>Erweitert: Regelkreis</translation>
    </message>
    <message>
        <source>Look</source>
        <translation>Aussehen</translation>
    </message>
    <message>
        <source>Overlay</source>
        <translation>Überlagerung</translation>
    </message>
    <message>
        <source>Fee&amp;l</source>
        <translation>F&amp;ühlen</translation>
    </message>
    <message>
        <source>L&amp;ook</source>
        <translation>A&amp;ussehen</translation>
    </message>
    <message>
        <source>D&amp;ata</source>
        <translation>Date&amp;n</translation>
    </message>
    <message>
        <source>Devi&amp;ce</source>
        <translation>&amp;Gerät</translation>
    </message>
    <message>
        <source>Tool</source>
        <translation>Werkzeug</translation>
    </message>
    <message>
        <source>Pressing through</source>
        <translation>Durchdrücken</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::PenetrabilityControls</name>
    <message>
        <source>Add range</source>
        <translation>Bereich hinzufügen</translation>
    </message>
    <message>
        <source>Another range of interest; or shift-drag on the histogram</source>
        <translation>Ein weiterer Wertebereich; oder Umschalt+Ziehen auf dem Histogramm</translation>
    </message>
    <message>
        <source>Layers are felt: their surfaces give way by puncture forces. Choose No layers to press through by depth</source>
        <translation>Es werden Schichten gefühlt: Ihre Oberflächen geben bei ihrer Durchstoßkraft nach. Wählen Sie „Keine Schichten“, um nach Tiefe durchzudrücken</translation>
    </message>
    <message>
        <source>Surfaces give way</source>
        <translation>Oberflächen geben nach</translation>
    </message>
    <message>
        <source>Levels that are felt, from and to</source>
        <translation>Gefühlte Werte, von und bis</translation>
    </message>
    <message>
        <source>The least level of this range [data units]; also by the end of its band on the histogram. -inf: without an end</source>
        <translation>Der kleinste Wert dieses Bereichs [Dateneinheiten]; auch mit dem Ende seines Bandes auf dem Histogramm. -inf: ohne Ende</translation>
    </message>
    <message>
        <source>Range %1, from</source>
        <translation>Bereich %1, von</translation>
    </message>
    <message>
        <source>The greatest level of this range [data units]; also by the end of its band on the histogram. inf: without an end</source>
        <translation>Der größte Wert dieses Bereichs [Dateneinheiten]; auch mit dem Ende seines Bandes auf dem Histogramm. inf: ohne Ende</translation>
    </message>
    <message>
        <source>Range %1, to</source>
        <translation>Bereich %1, bis</translation>
    </message>
    <message>
        <source>Remove it</source>
        <translation>Entfernen</translation>
    </message>
    <message>
        <source>Remove range %1</source>
        <translation>Bereich %1 entfernen</translation>
    </message>
    <message>
        <source>the last range stays: switch pressing through off to have none</source>
        <translation>der letzte Bereich bleibt: Schalten Sie das Durchdrücken aus, um keinen zu haben</translation>
    </message>
    <message>
        <source>A surface that is pressed deep enough gives way: the level felt follows the hand</source>
        <translation>Eine Oberfläche, in die man tief genug drückt, gibt nach: Der gefühlte Wert folgt der Hand</translation>
    </message>
    <message>
        <source>Depth</source>
        <translation>Tiefe</translation>
    </message>
    <message>
        <source>How deep the hand presses before the surface gives way [mm of the hand]: the penetration threshold, PT. The spring never exceeds stiffness x PT.</source>
        <translation>Wie tief die Hand drückt, bevor die Oberfläche nachgibt [mm der Hand]: die Durchdringungsschwelle, PT. Die Feder übersteigt nie Steifigkeit x PT.</translation>
    </message>
    <message>
        <source>Depth at which surfaces give way</source>
        <translation>Tiefe, ab der Oberflächen nachgeben</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::PreferencesDialog</name>
    <message>
        <source>Preferences</source>
        <translation>Einstellungen</translation>
    </message>
    <message>
        <source>as the system</source>
        <translation>wie das System</translation>
    </message>
    <message>
        <source>light</source>
        <translation>hell</translation>
    </message>
    <message>
        <source>dark</source>
        <translation>dunkel</translation>
    </message>
    <message>
        <source> pixels</source>
        <translation> Pixel</translation>
    </message>
    <message>
        <source>automatic</source>
        <translation>automatisch</translation>
    </message>
    <message>
        <source>micrometres</source>
        <translation>Mikrometer</translation>
    </message>
    <message>
        <source>millimetres</source>
        <translation>Millimeter</translation>
    </message>
    <message>
        <source>centimetres</source>
        <translation>Zentimeter</translation>
    </message>
    <message>
        <source>inches</source>
        <translation>Zoll</translation>
    </message>
    <message>
        <source> million</source>
        <translation> Millionen</translation>
    </message>
    <message>
        <source>Theme</source>
        <translation>Farbschema</translation>
    </message>
    <message>
        <source>Colours of the window</source>
        <translation>Farben des Fensters</translation>
    </message>
    <message>
        <source>A notch of the wheel</source>
        <translation>Eine Raste des Rads</translation>
    </message>
    <message>
        <source>Moves the probe into the depth as far as a drag of so many pixels</source>
        <translation>Bewegt die Sonde so weit in die Tiefe wie ein Ziehen um so viele Pixel</translation>
    </message>
    <message>
        <source>Units of lengths</source>
        <translation>Längeneinheit</translation>
    </message>
    <message>
        <source>Of measurements</source>
        <translation>Von Messungen</translation>
    </message>
    <message>
        <source>Triangles of the surface</source>
        <translation>Dreiecke der Fläche</translation>
    </message>
    <message>
        <source>At most; a finer surface is thinned. A million takes about 80 MB</source>
        <translation>Höchstens; eine feinere Fläche wird ausgedünnt. Eine Million braucht etwa 80 MB</translation>
    </message>
    <message>
        <source>Language, from the next start</source>
        <translation>Sprache, ab dem nächsten Start</translation>
    </message>
    <message>
        <source>Of the window&apos;s words</source>
        <translation>Der Texte im Fenster</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::ProbeController</name>
    <message>
        <source>Click to touch, drag to move the probe, turn the wheel to push it in; the right button turns the view</source>
        <translation>Klicken berührt, Ziehen bewegt die Sonde, das Rad drückt sie hinein; die rechte Taste dreht die Ansicht</translation>
    </message>
    <message>
        <source>The probe is at the far side of the volume: nothing lies deeper</source>
        <translation>Die Sonde ist an der Rückseite des Volumens: Tiefer liegt nichts</translation>
    </message>
    <message>
        <source>Nudge the probe to the left</source>
        <translation>Sonde nach links schieben</translation>
    </message>
    <message>
        <source>Nudge the probe to the right</source>
        <translation>Sonde nach rechts schieben</translation>
    </message>
    <message>
        <source>Nudge the probe up</source>
        <translation>Sonde nach oben schieben</translation>
    </message>
    <message>
        <source>Nudge the probe down</source>
        <translation>Sonde nach unten schieben</translation>
    </message>
    <message>
        <source>Nudge the probe into the depth</source>
        <translation>Sonde in die Tiefe schieben</translation>
    </message>
    <message>
        <source>Nudge the probe towards you</source>
        <translation>Sonde nach vorn schieben</translation>
    </message>
    <message>
        <source>%1 by ten voxels</source>
        <translation>%1, um zehn Voxel</translation>
    </message>
    <message>
        <source>A point has no sides: choose a tool on the page Feel to turn it</source>
        <translation>Ein Punkt hat keine Seiten: zum Drehen auf der Seite Fühlen ein Werkzeug wählen</translation>
    </message>
    <message>
        <source>Turn the tool anticlockwise</source>
        <translation>Werkzeug gegen den Uhrzeigersinn drehen</translation>
    </message>
    <message>
        <source>Turn the tool clockwise</source>
        <translation>Werkzeug im Uhrzeigersinn drehen</translation>
    </message>
    <message>
        <source>Turn the tool down</source>
        <translation>Werkzeug nach unten drehen</translation>
    </message>
    <message>
        <source>Turn the tool to the left</source>
        <translation>Werkzeug nach links drehen</translation>
    </message>
    <message>
        <source>Turn the tool to the right</source>
        <translation>Werkzeug nach rechts drehen</translation>
    </message>
    <message>
        <source>Turn the tool up</source>
        <translation>Werkzeug nach oben drehen</translation>
    </message>
    <message>
        <source>Nothing can be touched here from in front of the cut</source>
        <translation>Hier lässt sich von vor dem Schnitt aus nichts berühren</translation>
    </message>
    <message>
        <source>The solid around this point has no outside</source>
        <translation>Der feste Bereich um diesen Punkt hat keine Außenseite</translation>
    </message>
    <message>
        <source>This point is inside: the probe touches in front of it. Drag to press deeper</source>
        <translation>Dieser Punkt liegt innen: Die Sonde berührt die Oberfläche davor. Ziehen Sie, um tiefer zu drücken</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::RawDialog</name>
    <message>
        <source>Skip the rest</source>
        <translation>Rest überspringen</translation>
    </message>
    <message>
        <source>Takes the bytes that are left over for a header</source>
        <translation>Hält die übrigen Bytes für einen Kopf</translation>
    </message>
    <message>
        <source>Raw data: %1</source>
        <translation>Rohdaten: %1</translation>
    </message>
    <message>
        <source>Samples</source>
        <translation>Abtastwerte</translation>
    </message>
    <message>
        <source>How many along x, which runs fastest, y and z</source>
        <translation>Wie viele entlang x (läuft am schnellsten), y und z</translation>
    </message>
    <message>
        <source>Sample type</source>
        <translation>Datentyp</translation>
    </message>
    <message>
        <source>Of each sample in the file</source>
        <translation>Jedes Abtastwerts in der Datei</translation>
    </message>
    <message>
        <source>Byte order</source>
        <translation>Bytereihenfolge</translation>
    </message>
    <message>
        <source>Of samples of two or four bytes</source>
        <translation>Von Abtastwerten mit zwei oder vier Bytes</translation>
    </message>
    <message>
        <source>Spacing [mm]</source>
        <translation>Abstand [mm]</translation>
    </message>
    <message>
        <source>Between samples along x, y and z</source>
        <translation>Zwischen Abtastwerten entlang x, y und z</translation>
    </message>
    <message>
        <source>Header [bytes]</source>
        <translation>Kopf [Bytes]</translation>
    </message>
    <message>
        <source>Skipped before the samples</source>
        <translation>Vor den Abtastwerten übersprungen</translation>
    </message>
    <message>
        <source>Samples along %1</source>
        <translation>Abtastwerte entlang %1</translation>
    </message>
    <message>
        <source>Spacing along %1</source>
        <translation>Abstand entlang %1</translation>
    </message>
    <message>
        <source>little-endian (PC)</source>
        <translation>Little-Endian (PC)</translation>
    </message>
    <message>
        <source>big-endian</source>
        <translation>Big-Endian</translation>
    </message>
    <message>
        <source>Slice of the preview</source>
        <translation>Schnitt der Vorschau</translation>
    </message>
    <message>
        <source>These samples are just what the file holds.</source>
        <translation>Diese Abtastwerte sind genau das, was die Datei enthält.</translation>
    </message>
    <message>
        <source>No preview</source>
        <translation>Keine Vorschau</translation>
    </message>
    <message>
        <source>These samples take %1 bytes once unpacked.</source>
        <translation>Diese Abtastwerte brauchen ausgepackt %1 Bytes.</translation>
    </message>
    <message>
        <source>The file holds %1 bytes, %2 more than these samples take.</source>
        <translation>Die Datei enthält %1 Bytes, %2 mehr, als diese Abtastwerte brauchen.</translation>
    </message>
    <message>
        <source>The file holds %1 bytes, %2 fewer than these samples take.</source>
        <translation>Die Datei enthält %1 Bytes, %2 weniger, als diese Abtastwerte brauchen.</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::RecordingController</name>
    <message>
        <source>Recording to %1</source>
        <translation>Aufzeichnung nach %1</translation>
    </message>
    <message>
        <source>the recording was cut off before its end</source>
        <translation>die Aufzeichnung wurde vor ihrem Ende abgeschnitten</translation>
    </message>
    <message>
        <source>Recorded %1 s</source>
        <translation>%1 s aufgezeichnet</translation>
    </message>
    <message>
        <source>A recording of %1 s</source>
        <translation>Eine Aufzeichnung von %1 s</translation>
    </message>
    <message numerus="yes">
        <source>%n ticks come out otherwise than they were recorded</source>
        <translation>
            <numerusform>%n Takt fällt anders aus, als er aufgezeichnet wurde</numerusform>
            <numerusform>%n Takte fallen anders aus, als sie aufgezeichnet wurden</numerusform>
        </translation>
    </message>
    <message>
        <source>the first %1 of %2 hands are shown</source>
        <translation>die ersten %1 von %2 Händen werden gezeigt</translation>
    </message>
    <message>
        <source>Recorded up to this change: the session began anew</source>
        <translation>Bis zu dieser Änderung aufgezeichnet: Die Sitzung hat neu begonnen</translation>
    </message>
    <message>
        <source>Preparing to record to %1</source>
        <translation>Die Aufzeichnung in %1 wird vorbereitet</translation>
    </message>
    <message>
        <source>Finishing the recording</source>
        <translation>Die Aufzeichnung wird abgeschlossen</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::SaveController</name>
    <message>
        <source>Volumes (%1)</source>
        <translation>Volumen (%1)</translation>
    </message>
    <message>
        <source>Save the volume</source>
        <translation>Volumen speichern</translation>
    </message>
    <message>
        <source>: it opens as the edited volume while the original stays where it is</source>
        <translation>: wird als das bearbeitete Volumen geöffnet, solange das Original bleibt, wo es ist</translation>
    </message>
    <message>
        <source>Saving %1</source>
        <translation>%1 wird gespeichert</translation>
    </message>
    <message>
        <source>Saved %1</source>
        <translation>%1 gespeichert</translation>
    </message>
    <message>
        <source>Save the surface (.ply, .stl, .obj or .vtp)</source>
        <translation>Oberfläche speichern (.ply, .stl, .obj oder .vtp)</translation>
    </message>
    <message>
        <source>Meshes (*.ply *.stl *.obj *.vtp)</source>
        <translation>Netze (*.ply *.stl *.obj *.vtp)</translation>
    </message>
    <message>
        <source>Making the surface</source>
        <translation>Die Oberfläche wird erzeugt</translation>
    </message>
    <message>
        <source>The surface has %1 triangles, more than many programs can work with. Simplify it to about %2? It stays closed, and what is left of its points stays on the surface.</source>
        <translation>Die Oberfläche hat %1 Dreiecke, mehr als viele Programme verarbeiten können. Auf etwa %2 vereinfachen? Sie bleibt geschlossen, und die Punkte, die übrig bleiben, bleiben auf der Oberfläche.</translation>
    </message>
    <message>
        <source>Simplify</source>
        <translation>Vereinfachen</translation>
    </message>
    <message>
        <source>All triangles</source>
        <translation>Alle Dreiecke</translation>
    </message>
    <message numerus="yes">
        <source>Saved %1, %2 triangles</source>
        <translation>
            <numerusform>%1 gespeichert, %2 Dreieck</numerusform>
            <numerusform>%1 gespeichert, %2 Dreiecke</numerusform>
        </translation>
    </message>
    <message>
        <source>The volume was edited, and not saved since. Save it?</source>
        <translation>Das Volumen wurde geändert und seitdem nicht gespeichert. Speichern?</translation>
    </message>
    <message>
        <source>This will name the volume&apos;s file, which has not the latest edits. Save the volume first?</source>
        <translation>Dies nennt die Datei des Volumens, in der die letzten Änderungen fehlen. Zuerst das Volumen speichern?</translation>
    </message>
    <message>
        <source>Without the edits</source>
        <translation>Ohne die Änderungen</translation>
    </message>
    <message>
        <source>The volume is still being saved</source>
        <translation>Das Volumen wird noch gespeichert</translation>
    </message>
    <message>
        <source>Zarr images (*.zarr)</source>
        <translation>Zarr-Bilder (*.zarr)</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Scene</name>
    <message>
        <source>3-D view</source>
        <translation>3D-Ansicht</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Section</name>
    <message>
        <source>Fold this part away or back</source>
        <translation>Diesen Teil ein- oder ausklappen</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::SeriesDialog</name>
    <message>
        <source>Series</source>
        <translation>Serie</translation>
    </message>
    <message>
        <source>Modality</source>
        <translation>Modalität</translation>
    </message>
    <message>
        <source>Slices</source>
        <translation>Schnitte</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>Spacing [mm]</source>
        <translation>Abstand [mm]</translation>
    </message>
    <message>
        <source>Patient</source>
        <translation>Patient</translation>
    </message>
    <message>
        <source>Study</source>
        <translation>Studie</translation>
    </message>
    <message>
        <source>%1 (stack %2)</source>
        <translation>%1 (Stapel %2)</translation>
    </message>
    <message>
        <source>Choose a series of %1</source>
        <translation>Serie von %1 wählen</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::SessionBar</name>
    <message>
        <source>Forces on or off (space bar). Off: zero at once; on: they ramp up</source>
        <translation>Kräfte an oder aus (Leertaste). Aus: sofort null; an: sie steigen an</translation>
    </message>
    <message numerus="yes">
        <source>%n points of the tool hold, torque %1 N mm</source>
        <translation>
            <numerusform>%n Punkt des Werkzeugs hält, Drehmoment %1 N mm</numerusform>
            <numerusform>%n Punkte des Werkzeugs halten, Drehmoment %1 N mm</numerusform>
        </translation>
    </message>
    <message>
        <source>frozen</source>
        <translation>eingefroren</translation>
    </message>
    <message>
        <source>clutched</source>
        <translation>gekuppelt</translation>
    </message>
    <message>
        <source>the motion has ended</source>
        <translation>Bewegung ist zu Ende</translation>
    </message>
    <message>
        <source>data is being read</source>
        <translation>Daten werden gelesen</translation>
    </message>
    <message>
        <source>no input from the device</source>
        <translation>keine Eingabe vom Gerät</translation>
    </message>
    <message>
        <source>withdraw a little</source>
        <translation>etwas zurückziehen</translation>
    </message>
    <message>
        <source>In contact, pull %1 mm</source>
        <translation>In Kontakt, Zug %1 mm</translation>
    </message>
    <message>
        <source>Free, pull %1 mm</source>
        <translation>Frei, Zug %1 mm</translation>
    </message>
    <message>
        <source>(%1 %2 in the volume)</source>
        <translation>(%1 %2 im Volumen)</translation>
    </message>
    <message>
        <source>Whether the proxy is on a surface, and how far it is from the hand (of the hand, and in the volume)</source>
        <translation>Ob der Proxy auf einer Oberfläche ist, und wie weit er von der Hand entfernt ist (der Hand, und im Volumen)</translation>
    </message>
    <message>
        <source>Forces are OFF</source>
        <translation>Kräfte sind AUS</translation>
    </message>
    <message>
        <source>Forces are ON</source>
        <translation>Kräfte sind AN</translation>
    </message>
    <message>
        <source>Forces WAIT</source>
        <translation>Kräfte WARTEN</translation>
    </message>
    <message>
        <source>Hand and proxy stand still for the session, forces are let go</source>
        <translation>Hand und Proxy stehen für die Sitzung still, Kräfte werden losgelassen</translation>
    </message>
    <message>
        <source>Frozen</source>
        <translation>Eingefroren</translation>
    </message>
    <message>
        <source>Freeze</source>
        <translation>Einfrieren</translation>
    </message>
    <message>
        <source>The volume hangs on the hand, to put it elsewhere; forces are let go</source>
        <translation>Das Volumen hängt an der Hand, um es zu versetzen; Kräfte werden losgelassen</translation>
    </message>
    <message>
        <source>Clutched</source>
        <translation>Gekuppelt</translation>
    </message>
    <message>
        <source>Clutch</source>
        <translation>Kuppeln</translation>
    </message>
    <message>
        <source>no tick yet</source>
        <translation>noch kein Takt</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::SlicePane</name>
    <message>
        <source>Sagittal</source>
        <translation>Sagittal</translation>
    </message>
    <message>
        <source>Coronal</source>
        <translation>Koronal</translation>
    </message>
    <message>
        <source>Axial</source>
        <translation>Axial</translation>
    </message>
    <message>
        <source>Slice</source>
        <translation>Schnitt</translation>
    </message>
    <message>
        <source>Wheel: next slice. Left: crosshair. Ctrl+left: the probe, if the mouse is the hand. Right drag: window (sideways) and level (up, down). Middle drag: move. Ctrl+wheel: zoom. Double click: this pane alone, or all again; with Shift: reset. Keys: arrows, Page Up and Down, +, -, Home.</source>
        <translation>Rad: nächster Schnitt. Links: Fadenkreuz. Strg+Links: die Sonde, wenn die Maus die Hand ist. Rechts ziehen: Fensterbreite (seitwärts) und Fensterlage (auf, ab). Mittlere Taste ziehen: verschieben. Strg+Rad: zoomen. Doppelklick: nur dieses Feld oder wieder alle; mit Umschalt: zurücksetzen. Tasten: Pfeile, Bild auf und ab, +, -, Pos1.</translation>
    </message>
    <message>
        <source>%1 slice</source>
        <translation>Schnitt %1</translation>
    </message>
    <message>
        <source>No volume</source>
        <translation>Kein Volumen</translation>
    </message>
    <message>
        <source>outside the data</source>
        <translation>außerhalb der Daten</translation>
    </message>
    <message>
        <source>W %1</source>
        <comment>window, in the corner</comment>
        <translation>W %1</translation>
    </message>
    <message>
        <source>L %1</source>
        <comment>level, in the corner</comment>
        <translation>L %1</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::StatusBar</name>
    <message>
        <source>The proxy: where it is, the sample there and its slope</source>
        <translation>Der Proxy: wo er ist, der Wert dort und dessen Steigung</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::StoreDialog</name>
    <message>
        <source>Look it up</source>
        <translation>Nachsehen</translation>
    </message>
    <message>
        <source>Reads which levels, channels and times there are</source>
        <translation>Liest, welche Stufen, Kanäle und Zeiten es gibt</translation>
    </message>
    <message>
        <source>Level, channel and time</source>
        <translation>Detailstufe, Kanal und Zeit</translation>
    </message>
    <message>
        <source>Open an address</source>
        <translation>Adresse öffnen</translation>
    </message>
    <message>
        <source>Address</source>
        <translation>Adresse</translation>
    </message>
    <message>
        <source>http, https or s3, or the folder or file of a volume that is read in parts</source>
        <translation>http, https oder s3, oder Ordner oder Datei eines Volumens, das stückweise gelesen wird</translation>
    </message>
    <message>
        <source>Level</source>
        <translation>Stufe</translation>
    </message>
    <message>
        <source>The level of detail that is felt, and the finest that is seen; 0 is the finest</source>
        <translation>Die Detailstufe, die gefühlt wird, und die feinste, die zu sehen ist; 0 ist die feinste</translation>
    </message>
    <message>
        <source>Channel</source>
        <translation>Kanal</translation>
    </message>
    <message>
        <source>Of an image with several</source>
        <translation>Eines Bilds mit mehreren</translation>
    </message>
    <message>
        <source>Time</source>
        <translation>Zeit</translation>
    </message>
    <message>
        <source>The moment of an image with several, from 0</source>
        <translation>Der Zeitpunkt eines Bilds mit mehreren, ab 0</translation>
    </message>
    <message>
        <source>Looking …</source>
        <translation>Wird nachgesehen …</translation>
    </message>
    <message>
        <source>All, as a sequence</source>
        <translation>Alle, als Folge</translation>
    </message>
    <message>
        <source>Plays them; each is read whole at this level</source>
        <translation>Spielt sie ab; jede wird auf dieser Stufe ganz gelesen</translation>
    </message>
    <message>
        <source>Status 403 means: not stored</source>
        <translation>Status 403 heißt: nicht gespeichert</translation>
    </message>
    <message>
        <source>S3 answers so for missing pieces where the list is not public</source>
        <translation>S3 antwortet so für fehlende Stücke, wo die Liste nicht öffentlich ist</translation>
    </message>
    <message>
        <source>Missing pieces</source>
        <translation>Fehlende Stücke</translation>
    </message>
    <message>
        <source>What a server answers for pieces that hold only the fill value</source>
        <translation>Was ein Server für Stücke antwortet, die nur den Füllwert enthalten</translation>
    </message>
    <message>
        <source>%1: %2 samples, every %3 %4, %5</source>
        <translation>%1: %2 Abtastwerte, alle %3 %4, %5</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::StrokePlot</name>
    <message>
        <source>Force over depth: the stroke so far, from its first contact, in the colours of the layers touched.
A stroke ends two seconds after the hand has left all layers.</source>
        <translation>Kraft über der Tiefe: der Zug bisher, ab dem ersten Kontakt, in den Farben der berührten Schichten.
Ein Zug endet zwei Sekunden, nachdem die Hand alle Schichten verlassen hat.</translation>
    </message>
    <message>
        <source>depth</source>
        <translation>Tiefe</translation>
    </message>
    <message>
        <source>force over depth: press into a layer</source>
        <translation>Kraft über Tiefe: in eine Schicht drücken</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Timeline</name>
    <message>
        <source>Step back</source>
        <translation>Schritt zurück</translation>
    </message>
    <message>
        <source>To the frame before</source>
        <translation>Zum Bild davor</translation>
    </message>
    <message>
        <source>Play</source>
        <translation>Abspielen</translation>
    </message>
    <message>
        <source>Step forward</source>
        <translation>Schritt vor</translation>
    </message>
    <message>
        <source>To the next frame</source>
        <translation>Zum nächsten Bild</translation>
    </message>
    <message>
        <source>The time shown [s] or [minutes:seconds], and the frame there or the length</source>
        <translation>Die gezeigte Zeit [s] oder [Minuten:Sekunden], und das Bild dort oder die Länge</translation>
    </message>
    <message>
        <source>Seconds played in a second, 0.1 to 10</source>
        <translation>Abgespielte Sekunden je Sekunde, 0,1 bis 10</translation>
    </message>
    <message>
        <source>&amp;Loop</source>
        <translation>&amp;Wiederholen</translation>
    </message>
    <message>
        <source>After the end it begins again</source>
        <translation>Nach dem Ende beginnt es von vorn</translation>
    </message>
    <message>
        <source>Speed</source>
        <translation>Geschwindigkeit</translation>
    </message>
    <message>
        <source>Pause</source>
        <translation>Anhalten</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::TimelineTrack</name>
    <message>
        <source>Time [ms]</source>
        <translation>Zeit [ms]</translation>
    </message>
    <message>
        <source>Arrows go from frame to frame</source>
        <translation>Pfeile gehen von Bild zu Bild</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::ToolControls</name>
    <message numerus="yes">
        <source>%n points, %1 mm apart.</source>
        <translation>
            <numerusform>%n Punkt, Abstand %1 mm.</numerusform>
            <numerusform>%n Punkte, Abstand %1 mm.</numerusform>
        </translation>
    </message>
    <message numerus="yes">
        <source>%n points.</source>
        <translation>
            <numerusform>%n Punkt.</numerusform>
            <numerusform>%n Punkte.</numerusform>
        </translation>
    </message>
    <message>
        <source>A tool from a file: a mesh (STL, PLY, OBJ, VTP) or points (CSV: x, y, z), in mm from the point that is held</source>
        <translation>Ein Werkzeug aus einer Datei: ein Netz (STL, PLY, OBJ, VTP) oder Punkte (CSV: x, y, z), in mm von dem Punkt aus, der gehalten wird</translation>
    </message>
    <message>
        <source>This session&apos;s tool</source>
        <translation>Werkzeug dieser Sitzung</translation>
    </message>
    <message>
        <source>Ball</source>
        <translation>Kugel</translation>
    </message>
    <message>
        <source>Box</source>
        <translation>Quader</translation>
    </message>
    <message>
        <source>Burr</source>
        <translation>Fräser</translation>
    </message>
    <message>
        <source>Fingertip</source>
        <translation>Fingerkuppe</translation>
    </message>
    <message>
        <source>How many times as large as usual the tool is</source>
        <translation>Wievielmal so groß wie üblich das Werkzeug ist</translation>
    </message>
    <message>
        <source>Layers, pressing through, magnet and texture are felt with a point only.</source>
        <translation>Schichten, Durchdrücken, Magnet und Textur sind nur mit einem Punkt zu fühlen.</translation>
    </message>
    <message>
        <source>Needle</source>
        <translation>Nadel</translation>
    </message>
    <message>
        <source>Open a tool</source>
        <translation>Werkzeug öffnen</translation>
    </message>
    <message>
        <source>Open…</source>
        <translation>Öffnen …</translation>
    </message>
    <message>
        <source>Point</source>
        <translation>Punkt</translation>
    </message>
    <message>
        <source>Rod</source>
        <translation>Stab</translation>
    </message>
    <message>
        <source>Size</source>
        <translation>Größe</translation>
    </message>
    <message>
        <source>Size of the tool</source>
        <translation>Größe des Werkzeugs</translation>
    </message>
    <message>
        <source>Tool</source>
        <translation>Werkzeug</translation>
    </message>
    <message>
        <source>What touches. No point of a tool ever goes through the surface; it pushes and turns the hand. With the mouse, Ctrl and drag in the scene turn it.</source>
        <translation>Womit berührt wird. Kein Punkt eines Werkzeugs geht je durch die Oberfläche; es drückt und dreht die Hand. Mit der Maus drehen es Strg und Ziehen in der Szene.</translation>
    </message>
    <message>
        <source>%1: this is a tool: open a volume first, and feel it, then open the tool</source>
        <translation>%1: das ist ein Werkzeug: zuerst ein Volumen öffnen und fühlen, dann das Werkzeug öffnen</translation>
    </message>
    <message>
        <source>Reading the tool</source>
        <translation>Werkzeug wird gelesen</translation>
    </message>
    <message>
        <source>Tools (*.stl *.ply *.obj *.vtp *.csv);;All files (*)</source>
        <translation>Werkzeuge (*.stl *.ply *.obj *.vtp *.csv);;Alle Dateien (*)</translation>
    </message>
    <message>
        <source>Making the tool</source>
        <translation>Das Werkzeug wird erzeugt</translation>
    </message>
</context>
<context>
    <name>palpate::viewer::Welcome</name>
    <message>
        <source>Open a volume…</source>
        <translation>Volumen öffnen …</translation>
    </message>
    <message>
        <source>Open a folder…</source>
        <translation>Ordner öffnen …</translation>
    </message>
    <message>
        <source>Feel the sample head</source>
        <translation>Den Beispielkopf fühlen</translation>
    </message>
    <message>
        <source>A CT scan of a head</source>
        <translation>Die CT-Aufnahme eines Kopfes</translation>
    </message>
    <message>
        <source>Palpate: feel volumes</source>
        <translation>Palpate: Volumen fühlen</translation>
    </message>
    <message>
        <source>Recent</source>
        <translation>Zuletzt geöffnet</translation>
    </message>
    <message>
        <source>Click a surface to touch it; drag to move along, hold the button or turn the wheel to press.
The right button turns the view.
Drag the line in the histogram to feel another level. The page Feel lets you press through surfaces.</source>
        <translation>Klicken Sie auf eine Oberfläche, um sie zu berühren; ziehen Sie, um entlangzufahren, halten Sie die Taste oder drehen Sie das Rad, um zu drücken.
Die rechte Taste dreht die Ansicht.
Ziehen Sie die Linie im Histogramm, um einen anderen Wert zu fühlen. Auf der Seite Fühlen lässt sich durch Oberflächen drücken.</translation>
    </message>
    <message>
        <source>NRRD, MetaImage, NIfTI, DICOM, TIFF, HDF5, VTI, raw; a session or a recording</source>
        <translation>NRRD, MetaImage, NIfTI, DICOM, TIFF, HDF5, VTI, Rohdaten; eine Sitzung oder Aufzeichnung</translation>
    </message>
    <message>
        <source>DICOM series, TIFF slices, Zarr and N5 stores. Ctrl+L opens an address</source>
        <translation>DICOM-Serien, TIFF-Schichten, Zarr- und N5-Speicher. Strg+L öffnet eine Adresse</translation>
    </message>
</context>
</TS>
